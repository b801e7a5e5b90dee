/* Gaps of two features, with their normals from the first to the second one and the places halfway
   between their surfaces */
/* two balls of radii r and s */
static casadi_real casadi_ball_gap(const casadi_real* here, casadi_real r,
    const casadi_real* there, casadi_real s, casadi_real* normal, casadi_real* place) {
  casadi_int k;
  casadi_real gap;
  casadi_between(here, there, normal);
  gap = casadi_unit(normal) - r - s;
  for (k=0; k<3; ++k) place[k] = here[k] + (r + gap/2)*normal[k];
  return gap;
}
/* a plane with a normal, and a ball */
static casadi_real casadi_wall_gap(const casadi_real* point, const casadi_real* center,
    casadi_real radius, const casadi_real* normal, casadi_real* place) {
  casadi_int k;
  casadi_real relative[3], gap;
  casadi_between(point, center, relative);
  gap = casadi_dot(normal, relative) - radius;
  for (k=0; k<3; ++k) place[k] = center[k] - (radius + gap/2)*normal[k];
  return gap;
}
/* corners of an edge, reversed if its number is one of the second half */
static void casadi_ends(const int* form, casadi_int edge, int* ends) {
  const int* corner = form + form[EDGE_CORNERS] + 2*(edge<form[EDGES] ? edge : edge - form[EDGES]);
  ends[0] = edge<form[EDGES] ? corner[0] : corner[1];
  ends[1] = edge<form[EDGES] ? corner[1] : corner[0];
}
/* two edges */
static casadi_real casadi_edge_gap(const int* a, const casadi_real* x, casadi_real r,
    casadi_int own, const int* b, const casadi_real* y, casadi_real s, casadi_int other,
    casadi_real* normal, casadi_real* place) {
  casadi_int k;
  int i[2], j[2];
  casadi_real u[3], v[3], between[3], turned[3], gap, fraction, square;
  casadi_ends(a, own, i);
  casadi_ends(b, other, j);
  casadi_between(x + 3*i[0], x + 3*i[1], u);
  casadi_between(y + 3*j[0], y + 3*j[1], v);
  casadi_between(x + 3*i[0], y + 3*j[0], between);
  casadi_cross(u, v, normal);
  square = casadi_dot(normal, normal);
  casadi_cross(between, v, turned);
  fraction = casadi_dot(turned, normal)/square;
  casadi_unit(normal);
  gap = casadi_dot(normal, between) - r - s;
  for (k=0; k<3; ++k) place[k] = x[3*i[0]+k] + fraction*u[k] + normal[k]*(r + gap/2);
  return gap;
}
/* features of hulls with axes n of the first one: 1 a face, 2 a corner and 4 an edge with a corner,
   or 3 two edges */
static casadi_real casadi_feature_gap(casadi_int kind, const int* a, const casadi_real* x,
    const casadi_real* n, casadi_real r, casadi_int own, const int* b, const casadi_real* y,
    casadi_real s, casadi_int other, casadi_int dimension, casadi_real* normal,
    casadi_real* place) {
  casadi_int k;
  int ends[2];
  casadi_real foot[3], line[3], gap, fraction;
  if (kind==1) {
    k = dimension==2 ? own : a[a[LOOP_CORNERS]+a[a[LOOP_STARTS]+own]];
    gap = casadi_wall_gap(x + 3*k, y + 3*other, s + r, n + 3*own, place);
    for (k=0; k<3; ++k) {
      normal[k] = n[3*own+k];
      place[k] = y[3*other+k] - (s + gap/2)*normal[k];
    }
    return gap;
  }
  if (kind==2) return casadi_ball_gap(x + 3*own, r, y + 3*other, s, normal, place);
  if (kind==3) return casadi_edge_gap(a, x, r, own, b, y, s, other, normal, place);
  casadi_ends(a, own, ends);
  casadi_between(x + 3*ends[0], x + 3*ends[1], line);
  casadi_between(x + 3*ends[0], y + 3*other, foot);
  fraction = casadi_dot(foot, line)/casadi_dot(line, line);
  for (k=0; k<3; ++k) foot[k] = x[3*ends[0]+k] + fraction*line[k];
  return casadi_ball_gap(foot, r, y + 3*other, s, normal, place);
}
