/* Contacts near each other at the start of a step, of which some are active. They are stored: directions in
   res[51] with rows and columns in res[52] and res[53], velocities before and at the end without impulses in
   res[54] and res[55], gaps, keys, descriptions and kept directions in res[56] to res[59], normals from the
   shape with the lower number in res[60], and states in res[61]: whether a contact leaves its face (0), is
   idle (1), active (2), or about to be added (3). The speeds at the end are in res[62]. Sizes are, from the
   tenth one, the numbers of stored contacts and of those about to be added, whether shapes may have an impact
   that the step misses, contacts may be added, and those about to be added are final, and the number of
   contacts of other features that are closed at the end, whose keys and descriptions are in res[65] and
   res[66] */
/* normal of a contact from the shape with the lower number */
static void casadi_signed_normal(const casadi_real** arg, const casadi_int* iw,
    const int* contact, casadi_real* normal) {
  casadi_real direction[9], point[3];
  casadi_int a;
  casadi_described_gap(arg, iw, contact, direction, point);
  for (a=0; a<3; ++a) normal[a] = contact[1]<contact[3] ? direction[a] : -direction[a];
}
/* append all contacts to the stored ones, with a state */
static void casadi_store(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    int state) {
  casadi_int* sizes = (casadi_int*) arg[47];
  const int* row = (const int*) arg[9];
  const int* contact = (const int*) arg[51];
  casadi_int first = sizes[STORED], rows = iw[CONTACTS]*iw[COMPONENTS], i, j, a, next;
  int* stored = (int*) res[52] + first*iw[COMPONENTS];
  if (first==0) stored[0] = 0;
  next = stored[0];
  for (j=0; j<=rows; ++j) stored[j] = next + row[j];
  for (j=0; j<row[rows]; ++j) {
    res[51][next+j] = arg[0][j];
    ((int*) res[53])[next+j] = ((const int*) arg[10])[j];
  }
  for (j=0; j<rows; ++j) {
    res[54][first*iw[COMPONENTS]+j] = res[24][j];
    res[55][first*iw[COMPONENTS]+j] = res[25][j];
  }
  for (i=0; i<iw[CONTACTS]; ++i, contact+=6) {
    next = first + i;
    res[56][next] = arg[45][i];
    ((casadi_int*) res[57])[next] = ((const casadi_int*) arg[43])[i];
    for (a=0; a<6; ++a) ((int*) res[58])[6*next+a] = contact[a];
    ((int*) res[59])[next] = ((const int*) res[45])[i];
    casadi_signed_normal(arg, iw, contact, res[60] + 3*next);
    ((int*) res[61])[next] = state;
  }
  sizes[STORED] = first + iw[CONTACTS];
}
/* store all contacts; active are those whose gaps would close within a part of the step */
static void casadi_store_all(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[47];
  int* state = (int*) res[61];
  casadi_int i, a, width = iw[COMPONENTS], linear = iw[GROUPS]>0 ? ((const int*) arg[13])[1] : 1;
  casadi_real forced = 0, fastest = 0, speed;
  sizes[STORED] = 0;
  casadi_store(arg, res, iw, 1);
  for (i=0; i<iw[CONTACTS]; ++i) {
    if (((const int*) res[50])[i]) state[i] = 0;
    if (state[i]==0) continue;
    if (res[56][i] + arg[LIMITS][GAMMA]*arg[LIMITS][LENGTH]*res[24][i*width]<=arg[LIMITS][ROUNDING])
      state[i] = 2;
    speed = fabs(res[25][i*width] - res[24][i*width]);
    if (!(speed<=forced)) forced = speed;
    for (a=i*width; a<i*width+linear; ++a) {
      if (!(fabs(res[24][a])<=fastest)) fastest = fabs(res[24][a]);
      if (!(fabs(res[25][a])<=fastest)) fastest = fabs(res[25][a]);
    }
  }
  sizes[OPENS] = arg[LIMITS][PROJECTS]>0 && forced>arg[SHARES][NEWTON_SHARE]*arg[LIMITS][TOLERANCE]*fastest;
  res[11][5] = forced;
}
/* store the contacts of other features, where the shapes are at the start of the step; 1 if there are more
   contacts than memory */
static int casadi_store_others(const casadi_real** arg, casadi_real** res, casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[47];
  const int* contact = (const int*) res[66];
  casadi_real gap, direction[9], point[3];
  casadi_int i, count = sizes[OTHERS];
  sizes[OTHERS] = 0;
  if (sizes[STORED]+count>iw[MAX_CONTACTS]) return 1;
  iw[CONTACTS] = 0;
  ((int*) arg[9])[0] = 0;
  casadi_all_axes(arg, iw);
  for (i=0; i<count; ++i, contact+=6) {
    gap = casadi_described_gap(arg, iw, contact, direction, point);
    casadi_add_contact(arg, res, iw, contact, ((const casadi_int*) res[65])[i], gap, direction,
      point);
  }
  casadi_take_middle(arg, res, iw);
  casadi_store(arg, res, iw, 3);
  sizes[ADDED] = count;
  return 0;
}
/* the stored contacts that are active or about to be added, with initial impulses by their keys */
static void casadi_gather(const casadi_real** arg, casadi_real** res, casadi_int* iw) {
  const casadi_int* sizes = (const casadi_int*) arg[47];
  const casadi_int* last = (const casadi_int*) arg[44];
  const casadi_int* keys = (const casadi_int*) res[57];
  const int* stored = (const int*) res[52];
  const int* law = (const int*) arg[33];
  const int* contact;
  int* table = (int*) arg[46];
  int* row = (int*) arg[9];
  casadi_int width = iw[COMPONENTS], groups = iw[GROUPS], i, j, a, g, n, r, s, next, slot;
  casadi_index(table, sizes[SLOTS], last, sizes[LAST_IMPULSES]);
  iw[CONTACTS] = 0;
  row[0] = 0;
  for (i=0; i<sizes[STORED]; ++i) {
    if (((const int*) res[61])[i]<2) continue;
    n = iw[CONTACTS];
    iw[CONTACTS] = n + 1;
    contact = (const int*) res[58] + 6*i;
    slot = table[casadi_slot(table, sizes[SLOTS], last, keys[i])];
    for (a=0; a<width; ++a) {
      r = n*width + a;
      s = i*width + a;
      next = row[r];
      for (j=stored[s]; j<stored[s+1]; ++j, ++next) {
        ((casadi_real*) arg[0])[next] = res[51][j];
        ((int*) arg[10])[next] = ((const int*) res[53])[j];
      }
      row[r+1] = next;
      res[24][r] = res[54][s];
      res[25][r] = res[55][s];
      res[48][r] = res[55][s];
      res[0][r] = slot<0 ? 0.0 : res[29][slot*width+a];
    }
    ((casadi_real*) arg[45])[n] = res[56][i];
    res[22][n] = res[56][i];
    ((casadi_int*) arg[43])[n] = keys[i];
    ((int*) res[45])[n] = ((const int*) res[59])[i];
    ((int*) res[23])[n] = contact[5];
    for (a=0; a<6; ++a) ((int*) arg[51])[6*n+a] = contact[a];
    for (g=0; g<groups; ++g) {
      ((casadi_real*) arg[3])[n*groups+g] = arg[28][law[contact[5]]*(2+groups)+2+g];
    }
    casadi_response_rows(arg, res, iw, n, contact[1], contact[3]);
  }
}
/* change a state of stored contacts into another one */
static void casadi_exchange(casadi_real** res, casadi_int count, int old, int other) {
  int* state = (int*) res[61];
  casadi_int i;
  for (i=0; i<count; ++i) {
    if (state[i]==old) state[i] = other;
  }
}
/* gather the contacts with those about to be added; without contacts that open faster than forces change
   speeds if one has an impact. The outcome */
static casadi_int casadi_join(const casadi_real** arg, casadi_real** res, casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[47];
  int* state = (int*) res[61];
  casadi_int i, impact = 0;
  casadi_real limits[2];
  casadi_gather(arg, res, iw);
  if (sizes[FINAL]) return 0;
  sizes[FINAL] = 1;
  casadi_changes(arg, res, iw);
  for (i=0; i<iw[CONTACTS]; ++i) {
    if (res[24][i*iw[COMPONENTS]]<0 && casadi_strikes(arg, res, iw, i)) impact = 1;
  }
  if (!impact) return 0;
  casadi_largest(arg, res, iw, limits);
  for (i=0; i<sizes[STORED]; ++i) {
    if (state[i]!=3 || res[54][i*iw[COMPONENTS]]<=arg[SHARES][SLOW]*limits[0]) continue;
    state[i] = 1;
    --sizes[ADDED];
  }
  if (sizes[ADDED]==0) return 8;
  casadi_gather(arg, res, iw);
  return 0;
}
