/* Forms and axes of convex hulls. The axes of a spatial hull are the normals of its faces, then the
   directions of its groups of edges; those of a planar one the normals of its edges */
static casadi_real casadi_dot(const casadi_real* a, const casadi_real* b) {
  return a[0]*b[0] + a[1]*b[1] + a[2]*b[2];
}
static void casadi_cross(const casadi_real* a, const casadi_real* b, casadi_real* c) {
  c[0] = a[1]*b[2] - a[2]*b[1];
  c[1] = a[2]*b[0] - a[0]*b[2];
  c[2] = a[0]*b[1] - a[1]*b[0];
}
static void casadi_between(const casadi_real* a, const casadi_real* b, casadi_real* c) {
  c[0] = b[0] - a[0];
  c[1] = b[1] - a[1];
  c[2] = b[2] - a[2];
}
/* unit vector; the zero vector remains. The length */
static casadi_real casadi_unit(casadi_real* a) {
  casadi_real length = sqrt(casadi_dot(a, a));
  casadi_int k;
  if (length>0) {
    for (k=0; k<3; ++k) a[k] = a[k]/length;
  }
  return length;
}
/* edge as a vector */
static void casadi_line(const int* form, const casadi_real* x, casadi_int edge,
    casadi_real* line) {
  const int* ends = form + form[EDGE_CORNERS] + 2*edge;
  casadi_between(x + 3*ends[0], x + 3*ends[1], line);
}
/* smallest and largest coordinates of corners along a direction */
static void casadi_extent(const casadi_real* x, casadi_int count, const casadi_real* direction,
    casadi_real* range) {
  casadi_int k;
  casadi_real along = casadi_dot(x, direction);
  range[0] = along;
  range[1] = along;
  for (k=1; k<count; ++k) {
    along = casadi_dot(x + 3*k, direction);
    if (along<range[0]) range[0] = along;
    if (along>range[1]) range[1] = along;
  }
}
/* the largest extent along a coordinate axis of two sets of corners together */
static casadi_real casadi_span(const casadi_real* x, casadi_int count, const casadi_real* y,
    casadi_int other) {
  casadi_int k, a;
  casadi_real low, high, largest = 0;
  for (a=0; a<3; ++a) {
    low = x[a];
    high = x[a];
    for (k=1; k<count; ++k) {
      if (x[3*k+a]<low) low = x[3*k+a];
      if (x[3*k+a]>high) high = x[3*k+a];
    }
    for (k=0; k<other; ++k) {
      if (y[3*k+a]<low) low = y[3*k+a];
      if (y[3*k+a]>high) high = y[3*k+a];
    }
    if (high - low>largest) largest = high - low;
  }
  return largest;
}
/* axes of a hull */
static void casadi_axes(const int* form, const casadi_real* x, casadi_int dimension,
    casadi_real* axis) {
  const int* start = form + form[LOOP_STARTS];
  const int* loop = form + form[LOOP_CORNERS];
  const int* group = form + form[GROUP_STARTS];
  const int* member = form + form[GROUP_EDGES];
  casadi_int k, corners = form[CORNERS];
  casadi_real u[3], v[3];
  if (dimension==2) {
    for (k=0; k<corners; ++k) {
      casadi_between(x + 3*k, x + (k+1<corners ? 3*(k+1) : 0), u);
      casadi_unit(u);
      axis[3*k] = u[1];
      axis[3*k+1] = -u[0];
      axis[3*k+2] = 0;
    }
    return;
  }
  for (k=0; k<form[FACES]; ++k) {
    casadi_between(x + 3*loop[start[k]], x + 3*loop[start[k]+1], u);
    casadi_between(x + 3*loop[start[k]+1], x + 3*loop[start[k]+2], v);
    casadi_cross(u, v, axis + 3*k);
    casadi_unit(axis + 3*k);
  }
  for (k=0; k<form[GROUPS]; ++k) {
    casadi_line(form, x, member[group[k]], axis + 3*(form[FACES]+k));
    casadi_unit(axis + 3*(form[FACES]+k));
  }
}
/* append a pair of features: its kind, whether the second hull is first, and both features */
static casadi_int casadi_append(int* rows, casadi_int count, casadi_int kind, casadi_int swapped,
    casadi_int own, casadi_int other) {
  rows[4*count] = kind;
  rows[4*count+1] = swapped;
  rows[4*count+2] = own;
  rows[4*count+3] = other;
  return count + 1;
}
/* nearest corners of two hulls in place, and the distance of the hulls along their line; -infinity
   where these coincide */
static casadi_real casadi_nearest_corners(const casadi_real* x, casadi_int count,
    const casadi_real* y, casadi_int other, casadi_int* place) {
  casadi_int i, j;
  casadi_real along[3], best[3], own[2], theirs[2], square, least = INFINITY;
  place[0] = 0;
  place[1] = 0;
  for (i=0; i<3; ++i) best[i] = 0;
  for (i=0; i<count; ++i) {
    for (j=0; j<other; ++j) {
      casadi_between(x + 3*i, y + 3*j, along);
      square = casadi_dot(along, along);
      if (!(square<least)) continue;
      least = square;
      place[0] = i;
      place[1] = j;
      casadi_between(x + 3*i, y + 3*j, best);
    }
  }
  if (!(casadi_unit(best)>0)) return -INFINITY;
  casadi_extent(x, count, best, own);
  casadi_extent(y, other, best, theirs);
  return theirs[0] - own[1];
}
