/* Correction of positions: the nearest ones, by kinetic energy, with open gaps */
/* displacement along M^-1 that opens the gaps where the shapes are, with the entries of M in arg[MASS] and
   the inverses of its blocks in res[MASS_INVERSES] and res[LAST_MASS]; the outcome */
static casadi_int casadi_correct(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w) {
  const casadi_real* inputs[66];
  casadi_real* outputs[66];
  const int* contact;
  casadi_int i, k, r, a, width = iw[COMPONENTS], groups = iw[GROUPS];
  casadi_real reach[2], other[2], scale;
  for (i=0; i<66; ++i) {
    inputs[i] = arg[i];
    outputs[i] = res[i];
  }
  inputs[INERTIA] = arg[MASS];
  outputs[INVERSES] = res[MASS_INVERSES];
  outputs[LAST_INERTIA] = res[LAST_MASS];
  reach[0] = 0;
  reach[1] = 0;
  casadi_fastest(arg, iw, arg[SPEEDS], reach);
  for (i=0; i<2; ++i) reach[i] = 2*arg[LIMITS][LENGTH]*reach[i];
  for (k=0; k<20; ++k) {
    res[STATUS][REACH] = reach[0]>reach[1] ? reach[0] : reach[1];
    if (!casadi_listed(arg, iw, res[STATUS][REACH])) return OUTDATED;
    res[STATUS][DEEPEST] = casadi_contacts(arg, res, iw, reach);
    if (iw[CONTACTS]>iw[MAX_CONTACTS]) return MORE;
    if (res[STATUS][DEEPEST]>=-arg[LIMITS][ROUNDING]) return DONE;
    if (casadi_invert(inputs, outputs, iw, w)) return SINGULAR;
    scale = -res[STATUS][DEEPEST]>arg[LIMITS][LEAST_PENETRATION] ? -res[STATUS][DEEPEST]
      : arg[LIMITS][LEAST_PENETRATION];
    contact = (const int*) arg[DESCRIPTIONS];
    for (i=0; i<iw[CONTACTS]; ++i, contact+=6) {
      casadi_response_rows(inputs, outputs, iw, i, contact[SHAPE], contact[OTHER_SHAPE]);
      for (a=0; a<groups; ++a) ((casadi_real*) arg[FRICTION])[i*groups+a] = 0;
      for (r=i*width; r<(i+1)*width; ++r) {
        ((casadi_real*) arg[VELOCITY])[r] = r==i*width ? arg[GAPS][i] : 0.0;
        res[IMPULSE][r] = 0;
      }
    }
    if (casadi_contact_places(inputs, outputs, iw)) return UNORDERED;
    casadi_begin_impulses(inputs, outputs, iw, w);
    casadi_solution(inputs, outputs, iw, w, arg[LIMITS][TOLERANCE], scale);
    if (!(res[STATUS][RESIDUAL]<=arg[LIMITS][TOLERANCE]*casadi_size(arg, iw, res[IMPULSE], scale)))
      return UNSOLVED;
    casadi_shorten(arg, res[IMPULSE], iw);
    casadi_respond(arg[RESPONSES], (const int*) arg[RESPONSE_ROWS], (const int*) arg[RESPONSE_COLUMNS],
      res[IMPULSE], iw[CONTACTS]*width, iw[SPEEDS], res[DISPLACEMENT]);
    other[0] = 0;
    other[1] = 0;
    casadi_fastest(arg, iw, res[DISPLACEMENT], other);
    if (2*other[0]<=reach[0] && 2*other[1]<=reach[1]) return CLOSED;
    for (i=0; i<2; ++i) reach[i] = 2*other[i]>reach[i] ? 2*other[i] : reach[i];
  }
  return UNSOLVED;
}
