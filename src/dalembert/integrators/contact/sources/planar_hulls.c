/* Features of two planar hulls that touch first, by separating axes: 1 an edge with a corner, or 2
   two corners */
/* corners of polygon b over edge k of polygon a, and corners of a under the edge of b that meets it;
   or the lowest corner alone, which is beside the edge */
static casadi_int casadi_planar_edge(const int* a, const casadi_real* x, const casadi_real* n,
    const int* b, const casadi_real* y, const casadi_real* m, casadi_int k, casadi_int swapped,
    int* rows) {
  const casadi_real* normal = n + 3*k;
  const casadi_real* start = x + 3*k;
  casadi_int c, e, after, following = k+1<a[CORNERS] ? k+1 : 0, lowest = 0, count = 0, flush;
  casadi_int begins, finishes, under, over;
  casadi_real tangent[3], relative[3], edge[3], part[2], depth[2], nearest, height, least, square;
  casadi_real length, upper, lower, ends[2];
  tangent[0] = -normal[1];
  tangent[1] = normal[0];
  tangent[2] = 0;
  least = INFINITY;
  for (c=0; c<b[CORNERS]; ++c) {
    casadi_between(start, y + 3*c, relative);
    height = casadi_dot(relative, normal);
    if (height<least) {
      least = height;
      lowest = c;
    }
  }
  e = lowest>0 ? lowest - 1 : b[CORNERS] - 1;
  if (!(casadi_dot(m + 3*e, normal)<casadi_dot(m + 3*lowest, normal))) e = lowest;
  after = e+1<b[CORNERS] ? e+1 : 0;
  casadi_between(start, x + 3*following, relative);
  length = casadi_dot(relative, tangent);
  casadi_between(start, y + 3*e, relative);
  upper = casadi_dot(relative, tangent);
  ends[1] = casadi_dot(relative, normal);
  casadi_between(start, y + 3*after, relative);
  lower = casadi_dot(relative, tangent);
  ends[0] = casadi_dot(relative, normal);
  flush = casadi_dot(m + 3*e, normal)<-0.7 && upper>=0 && lower<=length;
  casadi_between(y + 3*e, y + 3*after, edge);
  square = casadi_dot(edge, edge);
  for (c=0; c<2; ++c) {
    casadi_between(y + 3*e, x + 3*(c ? following : k), relative);
    part[c] = casadi_dot(relative, edge);
    depth[c] = casadi_dot(relative, m + 3*e);
  }
  begins = flush && lower>=0;
  finishes = flush && upper<=length;
  under = flush && part[0]>=0 && part[0]<=square && !begins;
  over = flush && part[1]>=0 && part[1]<=square && !finishes;
  nearest = INFINITY;
  if (begins && ends[0]<nearest) nearest = ends[0];
  if (finishes && ends[1]<nearest) nearest = ends[1];
  if (under && depth[0]<nearest) nearest = depth[0];
  if (over && depth[1]<nearest) nearest = depth[1];
  if (nearest>least + 1e-3*casadi_span(y, b[CORNERS], y, 0)) {
    count = casadi_append(rows, count, 1, swapped, k, lowest);
  }
  if (begins) count = casadi_append(rows, count, 1, swapped, k, after);
  if (finishes) count = casadi_append(rows, count, 1, swapped, k, e);
  if (under) count = casadi_append(rows, count, 1, 1 - swapped, e, k);
  if (over) count = casadi_append(rows, count, 1, 1 - swapped, e, following);
  return count;
}
/* features of two polygons with normals n and m that touch first; none if their distance along an
   axis is above a limit */
static casadi_int casadi_planar_features(const int* a, const casadi_real* x, const casadi_real* n,
    const int* b, const casadi_real* y, const casadi_real* m, casadi_int rounded,
    casadi_real limit, int* rows) {
  casadi_int k, best = -1, corners[2];
  casadi_real largest = -INFINITY, apart, range[2];
  for (k=0; k<a[EDGES]; ++k) {
    casadi_extent(y, b[CORNERS], n + 3*k, range);
    apart = range[0] - casadi_dot(n + 3*k, x + 3*k);
    if (apart>limit) return 0;
    if (apart>largest) {
      largest = apart;
      best = k;
    }
  }
  for (k=0; k<b[EDGES]; ++k) {
    casadi_extent(x, a[CORNERS], m + 3*k, range);
    apart = range[0] - casadi_dot(m + 3*k, y + 3*k);
    if (apart>limit) return 0;
    if (apart>largest) {
      largest = apart;
      best = a[EDGES] + k;
    }
  }
  if (rounded) {
    apart = casadi_nearest_corners(x, a[CORNERS], y, b[CORNERS], corners);
    if (apart>limit) return 0;
    if (apart>largest) return casadi_append(rows, 0, 2, 0, corners[0], corners[1]);
  }
  if (best<0) return 0;
  if (best<a[EDGES]) return casadi_planar_edge(a, x, n, b, y, m, best, 0, rows);
  return casadi_planar_edge(b, y, m, a, x, n, best - a[EDGES], 1, rows);
}
