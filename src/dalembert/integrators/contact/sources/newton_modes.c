/* Semismooth Newton method called from outside: equations, line search, or all steps; or the whole
   solution, whose number of proximal problems is in status[ROUNDS] */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w,
    int mem) {
  casadi_real* pieces = w + iw[WORK] + iw[CONTACTS]*iw[COMPONENTS] + iw[MERITS];
  casadi_forget(pieces, iw[CONTACTS]);
  if (iw[MODE]==ASSEMBLE) return casadi_assemble(arg, res, iw, w, pieces, 0);
  if (iw[MODE]==SEARCH) return casadi_search(arg, res, iw, w);
  if (casadi_contact_places(arg, res, iw) || casadi_inertia_blocks(arg, res, iw)) return 1;
  if (iw[MODE]==ITERATE) return casadi_iterate(arg, res, iw, w)==1;
  res[STATUS][ROUNDS] = casadi_solution(arg, res, iw, w, arg[SETTINGS][RELATIVE_TOLERANCE],
    arg[SETTINGS][SCALE]);
  return 0;
}
