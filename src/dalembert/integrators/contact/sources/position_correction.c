/* Correction of positions: the nearest ones, by kinetic energy, with open gaps */
/* displacement along M^-1 that opens the gaps where the shapes are, with the entries of M in arg[64] and
   the inverses of its blocks in res[63] and res[64]; the outcome */
static casadi_int casadi_correct(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w) {
  const casadi_real* inputs[65];
  casadi_real* outputs[65];
  const int* contact;
  casadi_int i, k, r, a, width = iw[COMPONENTS], groups = iw[GROUPS];
  casadi_real reach[2], other[2], scale;
  for (i=0; i<65; ++i) {
    inputs[i] = arg[i];
    outputs[i] = res[i];
  }
  inputs[14] = arg[64];
  outputs[20] = res[63];
  outputs[21] = res[64];
  reach[0] = 0;
  reach[1] = 0;
  casadi_fastest(arg, iw, arg[22], reach);
  for (i=0; i<2; ++i) reach[i] = 2*arg[LIMITS][LENGTH]*reach[i];
  for (k=0; k<20; ++k) {
    res[11][3] = reach[0]>reach[1] ? reach[0] : reach[1];
    if (!casadi_listed(arg, iw, res[11][3])) return 2;
    res[11][4] = casadi_contacts(arg, res, iw, reach);
    if (iw[CONTACTS]>iw[MAX_CONTACTS]) return 7;
    if (res[11][4]>=-arg[LIMITS][ROUNDING]) return 0;
    if (casadi_invert(inputs, outputs, iw, w)) return 1;
    scale = -res[11][4]>arg[LIMITS][LEAST_PENETRATION] ? -res[11][4] : arg[LIMITS][LEAST_PENETRATION];
    contact = (const int*) arg[51];
    for (i=0; i<iw[CONTACTS]; ++i, contact+=6) {
      casadi_response_rows(inputs, outputs, iw, i, contact[1], contact[3]);
      for (a=0; a<groups; ++a) ((casadi_real*) arg[3])[i*groups+a] = 0;
      for (r=i*width; r<(i+1)*width; ++r) {
        ((casadi_real*) arg[2])[r] = r==i*width ? arg[45][i] : 0.0;
        res[0][r] = 0;
      }
    }
    if (casadi_contact_places(inputs, outputs, iw)) return 5;
    casadi_begin_impulses(inputs, outputs, iw, w);
    casadi_solution(inputs, outputs, iw, w, arg[LIMITS][TOLERANCE], scale);
    if (!(res[11][1]<=arg[LIMITS][TOLERANCE]*casadi_size(arg, iw, res[0], scale))) return 6;
    casadi_shorten(arg, res[0], iw);
    casadi_respond(arg[1], (const int*) arg[11], (const int*) arg[12], res[0], iw[CONTACTS]*width, iw[SPEEDS],
      res[28]);
    other[0] = 0;
    other[1] = 0;
    casadi_fastest(arg, iw, res[28], other);
    if (2*other[0]<=reach[0] && 2*other[1]<=reach[1]) return 4;
    for (i=0; i<2; ++i) reach[i] = 2*other[i]>reach[i] ? 2*other[i] : reach[i];
  }
  return 6;
}
