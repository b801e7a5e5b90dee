/* Features of pairs of hulls that touch first */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w,
    int mem) {
  const casadi_real* corners = arg[CORNERS];
  const casadi_real* limit = arg[REACH];
  const int* pair = (const int*) arg[PAIRS];
  const int* rounded = (const int*) arg[ROUNDED];
  const int* place = (const int*) arg[PLACES];
  const int* forms = (const int*) arg[FORMS];
  int* rows = (int*) res[FEATURES];
  int* part = (int*) res[PAIR_FEATURES];
  casadi_real* axes = res[AXES];
  casadi_int k, r, c, i, j, count, total = 0;
  const int* a;
  const int* b;
  for (k=0; k<iw[HULLS]; ++k) {
    if (place[3*k]<0) continue;
    casadi_axes(forms + place[3*k], corners + 3*place[3*k+CORNERS], iw[DIMENSION], axes + 3*place[3*k+AXES]);
  }
  for (k=0; k<iw[PAIRS]; ++k) {
    i = 3*pair[2*k];
    j = 3*pair[2*k+1];
    a = forms + place[i];
    b = forms + place[j];
    if (iw[DIMENSION]==2) {
      count = casadi_planar_features(a, corners + 3*place[i+CORNERS], axes + 3*place[i+AXES], b,
        corners + 3*place[j+CORNERS], axes + 3*place[j+AXES], rounded[k], limit[k], part);
    } else {
      count = casadi_spatial_features(a, corners + 3*place[i+CORNERS], axes + 3*place[i+AXES], b,
        corners + 3*place[j+CORNERS], axes + 3*place[j+AXES], rounded[k], limit[k], part, w);
    }
    for (r=0; r<count; ++r) {
      if (total<iw[MAX_FEATURES]) {
        rows[5*total] = part[4*r];
        rows[5*total+1] = k;
        for (c=1; c<4; ++c) rows[5*total+1+c] = part[4*r+c];
      }
      ++total;
    }
  }
  iw[FEATURES] = total;
  return 0;
}
