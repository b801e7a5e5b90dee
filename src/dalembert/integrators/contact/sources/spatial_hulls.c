/* Features of two spatial hulls that touch first, by separating axes: 1 a face, 2 two corners,
   3 two edges, 4 an edge, each of the second kinds with a corner */
/* distance along the common normal of two groups of edges, if it is larger than the best one and the
   edges are outermost; else -infinity */
static casadi_real casadi_edge_separation(const int* a, const casadi_real* x,
    const casadi_real* along, casadi_int i, const int* b, const casadi_real* y,
    const casadi_real* other, casadi_int j, casadi_real best, casadi_real* normal) {
  const int* group = a + a[GROUP_STARTS];
  const int* member = a + a[GROUP_EDGES];
  casadi_int k, flip;
  casadi_real own[2], theirs[2], apart, reached, size;
  casadi_cross(along, other, normal);
  if (!(casadi_unit(normal)>1e-6)) return -INFINITY;
  casadi_extent(x, a[CORNERS], normal, own);
  casadi_extent(y, b[CORNERS], normal, theirs);
  flip = own[0] - theirs[1]>theirs[0] - own[1];
  apart = flip ? own[0] - theirs[1] : theirs[0] - own[1];
  if (!(apart>best)) return -INFINITY;
  if (flip) {
    for (k=0; k<3; ++k) normal[k] = -normal[k];
    own[1] = -own[0];
    theirs[0] = -theirs[1];
  }
  size = casadi_span(x, a[CORNERS], x, 0) + casadi_span(y, b[CORNERS], y, 0);
  reached = -INFINITY;
  for (k=group[i]; k<group[i+1]; ++k) {
    apart = casadi_dot(normal, x + 3*a[a[EDGE_CORNERS]+2*member[k]]);
    if (apart>reached) reached = apart;
  }
  if (!(own[1] - reached<1e-9*size)) return -INFINITY;
  group = b + b[GROUP_STARTS];
  member = b + b[GROUP_EDGES];
  reached = INFINITY;
  for (k=group[j]; k<group[j+1]; ++k) {
    apart = casadi_dot(normal, y + 3*b[b[EDGE_CORNERS]+2*member[k]]);
    if (apart<reached) reached = apart;
  }
  if (!(reached - theirs[0]<1e-9*size)) return -INFINITY;
  return theirs[0] - own[1];
}
/* inward vectors of the sides of a face, by the inverse of their lengths */
static void casadi_inward(const casadi_real* x, const int* loop, casadi_int count,
    const casadi_real* normal, casadi_real* inward) {
  casadi_int k, c;
  casadi_real side[3], square;
  for (k=0; k<count; ++k) {
    casadi_between(x + 3*loop[k], x + 3*loop[k+1<count ? k+1 : 0], side);
    square = casadi_dot(side, side);
    casadi_cross(normal, side, inward + 3*k);
    for (c=0; c<3; ++c) inward[3*k+c] = inward[3*k+c]/square;
  }
}
/* smallest distance of a place from the sides of a face, by their lengths; positive inside */
static casadi_real casadi_depth(const casadi_real* x, const int* loop, casadi_int count,
    const casadi_real* inward, const casadi_real* place) {
  casadi_int k;
  casadi_real relative[3], depth, least = INFINITY;
  for (k=0; k<count; ++k) {
    casadi_between(x + 3*loop[k], place, relative);
    depth = casadi_dot(relative, inward + 3*k);
    if (depth<least) least = depth;
  }
  return least;
}
/* sides of two faces that cross along the normal of the first one, farther than a margin from their
   ends; the smallest distance of these and the value before in nearest */
static casadi_int casadi_crossings(const int* a, const casadi_real* x, casadi_int f, const int* b,
    const casadi_real* y, casadi_int g, const casadi_real* normal, casadi_int swapped,
    casadi_real margin, int* rows, casadi_int count, casadi_real* nearest) {
  const int* start = a + a[LOOP_STARTS];
  const int* sides = a + a[LOOP_EDGES];
  const int* other = b + b[LOOP_EDGES] + b[b[LOOP_STARTS]+g];
  casadi_int i, j, e, h, reverse, sides_b = b[FACES]>0 ? b[b[LOOP_STARTS]+g+1] - b[b[LOOP_STARTS]+g] : 1;
  casadi_real u[3], v[3], across[3], between[3], turned[3], area, size, first, second;
  if (!b[EDGES]) return count;
  for (i=start[f]; i<start[f+1]; ++i) {
    e = sides[i];
    casadi_line(a, x, e, u);
    for (j=0; j<sides_b; ++j) {
      h = other[j];
      casadi_line(b, y, h, v);
      casadi_cross(u, v, across);
      area = casadi_dot(across, normal);
      size = sqrt(casadi_dot(across, across));
      if (!(fabs(area)>0.7*size)) continue;
      if (!(size>1e-9*sqrt(casadi_dot(u, u))*sqrt(casadi_dot(v, v)))) continue;
      casadi_between(x + 3*a[a[EDGE_CORNERS]+2*e], y + 3*b[b[EDGE_CORNERS]+2*h], between);
      casadi_cross(between, v, turned);
      first = casadi_dot(turned, across)/(size*size);
      casadi_cross(between, u, turned);
      second = casadi_dot(turned, across)/(size*size);
      if (!(first>margin && first<1 - margin && second>margin && second<1 - margin)) continue;
      first = casadi_dot(between, across)/size;
      if (area<0) first = -first;
      if (first<nearest[0]) nearest[0] = first;
      reverse = area<0;
      if (swapped) count = casadi_append(rows, count, 3, 0, h, e + reverse*a[EDGES]);
      else count = casadi_append(rows, count, 3, 0, e, h + reverse*b[EDGES]);
    }
  }
  return count;
}
/* whether a place is over one of the corners in rows, along a normal */
static casadi_int casadi_over_corner(const casadi_real* y, const int* rows, casadi_int count,
    const casadi_real* normal, const casadi_real* place, casadi_real limit) {
  casadi_int k, c;
  casadi_real between[3], height;
  for (k=0; k<count; ++k) {
    casadi_between(y + 3*rows[4*k+3], place, between);
    height = casadi_dot(between, normal);
    for (c=0; c<3; ++c) between[c] = between[c] - height*normal[c];
    if (casadi_dot(between, between)<=limit*limit) return 1;
  }
  return 0;
}
/* contacts along the normal of face f of hull a: corners over it, corners under the face of the
   other hull that meets it, edges that cross, or the lowest corner alone, which is beside it */
static casadi_int casadi_face_rows(const int* a, const casadi_real* x, const casadi_real* n,
    const int* b, const casadi_real* y, const casadi_real* m, casadi_int f, casadi_int swapped,
    casadi_int farthest, int* rows, casadi_real* w) {
  const casadi_real* normal = n + 3*f;
  const int* own = a + a[LOOP_CORNERS] + a[a[LOOP_STARTS]+f];
  const int* other = b + b[LOOP_CORNERS];
  casadi_int own_count = a[a[LOOP_STARTS]+f+1] - a[a[LOOP_STARTS]+f], other_count, k, g = 0, lowest = 0,
    count = 0;
  casadi_int over;
  casadi_real nearest[1], facing, smallest = INFINITY, start, height, size;
  for (k=0; k<b[FACES]; ++k) {
    facing = casadi_dot(m + 3*k, normal);
    if (facing<smallest) {
      smallest = facing;
      g = k;
    }
  }
  other = other + b[b[LOOP_STARTS]+g];
  other_count = b[b[LOOP_STARTS]+g+1] - b[b[LOOP_STARTS]+g];
  start = casadi_dot(x + 3*own[0], normal);
  nearest[0] = INFINITY;
  casadi_inward(x, own, own_count, normal, w);
  for (k=0; k<other_count; ++k) {
    if (!(casadi_depth(x, own, own_count, w, y + 3*other[k])>=-1e-9)) continue;
    height = casadi_dot(y + 3*other[k], normal) - start;
    if (height<nearest[0]) nearest[0] = height;
    count = casadi_append(rows, count, 1, swapped, f, other[k]);
  }
  over = count;
  size = casadi_span(y, b[CORNERS], y, 0);
  if (smallest<-0.7) {
    casadi_inward(y, other, other_count, m + 3*g, w);
    for (k=0; k<own_count; ++k) {
      if (!(casadi_depth(y, other, other_count, w, x + 3*own[k])>=-1e-9)) continue;
      if (casadi_over_corner(y, rows, over, normal, x + 3*own[k], 1e-8*size)) continue;
      height = casadi_dot(x + 3*own[k], m + 3*g) - casadi_dot(y + 3*other[0], m + 3*g);
      if (height<nearest[0]) nearest[0] = height;
      count = casadi_append(rows, count, 1, 1 - swapped, g, own[k]);
    }
  }
  count = casadi_crossings(a, x, f, b, y, g, normal, swapped, 1e-9, rows, count, nearest);
  if (!count) {  /* an edge over two corners */
    count = casadi_crossings(a, x, f, b, y, g, normal, swapped, -1e-9, rows, count, nearest);
  }
  if (!farthest) return count;
  smallest = INFINITY;
  for (k=0; k<b[CORNERS]; ++k) {
    height = casadi_dot(y + 3*k, normal);
    if (height<smallest) {
      smallest = height;
      lowest = k;
    }
  }
  if (nearest[0]>smallest - start + 1e-3*size) {
    count = casadi_append(rows, count, 1, swapped, f, lowest);
  }
  return count;
}
/* edge of a group whose middle is farthest along a normal */
static casadi_int casadi_outermost(const int* form, const casadi_real* x, casadi_int group,
    const casadi_real* normal, casadi_real sign) {
  const int* start = form + form[GROUP_STARTS];
  const int* member = form + form[GROUP_EDGES];
  const int* edge = form + form[EDGE_CORNERS];
  casadi_int k, best = member[start[group]];
  casadi_real height, highest = -INFINITY;
  for (k=start[group]; k<start[group+1]; ++k) {
    height = sign*(casadi_dot(x + 3*edge[2*member[k]], normal)
      + casadi_dot(x + 3*edge[2*member[k]+1], normal));
    if (height>highest) {
      highest = height;
      best = member[k];
    }
  }
  return best;
}
/* edges that touch along a common normal, unless these are in the rows already */
static casadi_int casadi_edge_row(const int* a, const casadi_real* x, const int* b,
    const casadi_real* y, casadi_int i, casadi_int j, const casadi_real* normal, int* rows,
    casadi_int count) {
  casadi_int own = casadi_outermost(a, x, i, normal, 1.0), k;
  casadi_int other = casadi_outermost(b, y, j, normal, -1.0);
  casadi_real u[3], v[3], across[3];
  casadi_line(a, x, own, u);
  casadi_line(b, y, other, v);
  casadi_cross(u, v, across);
  if (casadi_dot(across, normal)<0) other += b[EDGES];
  for (k=0; k<count; ++k) {
    if (rows[4*k]==3 && rows[4*k+2]==own && rows[4*k+3]==other) return count;
  }
  return casadi_append(rows, count, 3, 0, own, other);
}
/* vector of the distance of a place from an edge; infinite beside its ends. Its length */
static casadi_real casadi_beside(const int* a, const casadi_real* x, casadi_int edge,
    const casadi_real* place, casadi_real* vector) {
  casadi_real line[3], fraction;
  casadi_int k;
  casadi_line(a, x, edge, line);
  casadi_between(x + 3*a[a[EDGE_CORNERS]+2*edge], place, vector);
  fraction = casadi_dot(vector, line)/casadi_dot(line, line);
  if (!(fraction>0 && fraction<1)) return INFINITY;
  for (k=0; k<3; ++k) vector[k] = vector[k] - fraction*line[k];
  return sqrt(casadi_dot(vector, vector));
}
/* distance along the shortest line between an edge of a hull and a corner of the other; the length
   of this line in least */
static casadi_real casadi_beside_edges(const int* a, const casadi_real* x, const int* b,
    const casadi_real* y, casadi_real* least) {
  casadi_int e, c, k;
  casadi_real vector[3], best[3], own[2], theirs[2], distance;
  least[0] = INFINITY;
  for (k=0; k<3; ++k) best[k] = 0;
  for (e=0; e<a[EDGES]; ++e) {
    for (c=0; c<b[CORNERS]; ++c) {
      distance = casadi_beside(a, x, e, y + 3*c, vector);
      if (!(distance<least[0])) continue;
      least[0] = distance;
      for (k=0; k<3; ++k) best[k] = vector[k];
    }
  }
  if (!(casadi_unit(best)>0)) return -INFINITY;
  casadi_extent(x, a[CORNERS], best, own);
  casadi_extent(y, b[CORNERS], best, theirs);
  return theirs[0] - own[1];
}
/* corners beside edges that are nearly as near as the nearest */
static casadi_int casadi_beside_rows(const int* a, const casadi_real* x, const int* b,
    const casadi_real* y, casadi_int swapped, casadi_real limit, int* rows, casadi_int count) {
  casadi_int e, c;
  casadi_real vector[3], distance;
  for (e=0; e<a[EDGES]; ++e) {
    for (c=0; c<b[CORNERS]; ++c) {
      distance = casadi_beside(a, x, e, y + 3*c, vector);
      if (distance<INFINITY && distance<=limit) {
        count = casadi_append(rows, count, 4, swapped, e, c);
      }
    }
  }
  return count;
}
/* features of two hulls with axes n and m that touch first; none if their distance along an axis is
   above a limit */
static casadi_int casadi_spatial_features(const int* a, const casadi_real* x,
    const casadi_real* n, const int* b, const casadi_real* y, const casadi_real* m,
    casadi_int rounded, casadi_real limit, int* rows, casadi_real* w) {
  casadi_int k, i, j, flat, crossed, best = 0, f = -1, column = -1, count = 0, corners[2];
  casadi_real face = -INFINITY, edge = -INFINITY, corner = -INFINITY, beside = -INFINITY;
  casadi_real range[2], normal[3], common[3], least[2], apart, size;
  for (k=0; k<a[FACES]; ++k) {
    casadi_extent(y, b[CORNERS], n + 3*k, range);
    apart = range[0] - casadi_dot(n + 3*k, x + 3*a[a[LOOP_CORNERS]+a[a[LOOP_STARTS]+k]]);
    if (apart>limit) return 0;
    if (apart>face) {
      face = apart;
      f = k;
    }
  }
  for (k=0; k<b[FACES]; ++k) {
    casadi_extent(x, a[CORNERS], m + 3*k, range);
    apart = range[0] - casadi_dot(m + 3*k, y + 3*b[b[LOOP_CORNERS]+b[b[LOOP_STARTS]+k]]);
    if (apart>limit) return 0;
    if (apart>face) {
      face = apart;
      f = a[FACES] + k;
    }
  }
  for (i=0; i<a[GROUPS]; ++i) {
    for (j=0; j<b[GROUPS]; ++j) {
      apart = casadi_edge_separation(a, x, n + 3*(a[FACES]+i), i, b, y, m + 3*(b[FACES]+j), j, edge,
        normal);
      if (apart>limit) return 0;
      if (apart>edge) {
        edge = apart;
        column = i*b[GROUPS] + j;
        for (k=0; k<3; ++k) common[k] = normal[k];
      }
    }
  }
  if (rounded) {
    corner = casadi_nearest_corners(x, a[CORNERS], y, b[CORNERS], corners);
    beside = casadi_beside_edges(a, x, b, y, least);
    apart = casadi_beside_edges(b, y, a, x, least + 1);
    if (apart>beside) beside = apart;
    if (corner>limit || beside>limit) return 0;
  }
  size = casadi_span(x, a[CORNERS], y, b[CORNERS]);
  apart = corner>beside ? corner : beside;
  flat = face>=edge - 1e-3*size && face>=apart - 1e-12*size;
  crossed = edge>face + 1e-12*size;
  if (corner>edge) best = 1;
  if (beside>(best==1 ? corner : edge)) best = 2;
  if (flat && f>=a[FACES]) {
    count = casadi_face_rows(b, y, m, a, x, n, f - a[FACES], 1, !crossed, rows, w);
  } else if (flat && f>=0) {
    count = casadi_face_rows(a, x, n, b, y, m, f, 0, !crossed, rows, w);
  }
  if (column>=0 && ((!flat && best==0) || (flat && crossed))) {
    count = casadi_edge_row(a, x, b, y, column/b[GROUPS], column%b[GROUPS], common, rows, count);
  }
  if (!flat && best==1) count = casadi_append(rows, count, 2, 0, corners[0], corners[1]);
  if (!flat && rounded && best!=1) {
    apart = 1.5*(least[0]<least[1] ? least[0] : least[1]);
    count = casadi_beside_rows(a, x, b, y, 0, apart, rows, count);
    count = casadi_beside_rows(b, y, a, x, 1, apart, rows, count);
  }
  return count;
}
