/* Contacts near each other at the start of a step, of which some are active, are stored in
   res[STORED_DIRECTIONS] to res[STATES] */
/* normal of a contact from the shape with the lower number */
static void casadi_signed_normal(const casadi_real** arg, const casadi_int* iw,
    const int* contact, casadi_real* normal) {
  casadi_real direction[9], point[3];
  casadi_int a;
  casadi_described_gap(arg, iw, contact, direction, point);
  for (a=0; a<3; ++a) normal[a] = contact[SHAPE]<contact[OTHER_SHAPE] ? direction[a] : -direction[a];
}
/* append all contacts to the stored ones, with a state */
static void casadi_store(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    int state) {
  casadi_int* sizes = (casadi_int*) arg[SIZES];
  const int* row = (const int*) arg[DIRECTION_ROWS];
  const int* contact = (const int*) arg[DESCRIPTIONS];
  casadi_int first = sizes[STORED], rows = iw[CONTACTS]*iw[COMPONENTS], i, j, a, next;
  int* stored = (int*) res[STORED_ROWS] + first*iw[COMPONENTS];
  if (first==0) stored[0] = 0;
  next = stored[0];
  for (j=0; j<=rows; ++j) stored[j] = next + row[j];
  for (j=0; j<row[rows]; ++j) {
    res[STORED_DIRECTIONS][next+j] = arg[DIRECTIONS][j];
    ((int*) res[STORED_COLUMNS])[next+j] = ((const int*) arg[DIRECTION_COLUMNS])[j];
  }
  for (j=0; j<rows; ++j) {
    res[STORED_BEFORE][first*iw[COMPONENTS]+j] = res[VELOCITY_BEFORE][j];
    res[STORED_FREE][first*iw[COMPONENTS]+j] = res[VELOCITY_FREE][j];
  }
  for (i=0; i<iw[CONTACTS]; ++i, contact+=6) {
    next = first + i;
    res[STORED_GAPS][next] = arg[GAPS][i];
    ((casadi_int*) res[STORED_KEYS])[next] = ((const casadi_int*) arg[KEYS])[i];
    for (a=0; a<6; ++a) ((int*) res[STORED_DESCRIPTIONS])[6*next+a] = contact[a];
    ((int*) res[STORED_START])[next] = ((const int*) res[START_DIRECTIONS])[i];
    casadi_signed_normal(arg, iw, contact, res[STORED_NORMALS] + 3*next);
    ((int*) res[STATES])[next] = state;
  }
  sizes[STORED] = first + iw[CONTACTS];
}
/* store all contacts; active are those whose gaps would close within a part of the step */
static void casadi_store_all(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[SIZES];
  int* state = (int*) res[STATES];
  casadi_int i, a, width = iw[COMPONENTS], linear = iw[GROUPS]>0 ? ((const int*) arg[GROUP_STARTS])[1] : 1;
  casadi_real forced = 0, fastest = 0, speed;
  sizes[STORED] = 0;
  casadi_store(arg, res, iw, IDLE);
  for (i=0; i<iw[CONTACTS]; ++i) {
    if (((const int*) res[LEAVING])[i]) state[i] = LEAVES;
    if (state[i]==LEAVES) continue;
    if (res[STORED_GAPS][i]
        + arg[LIMITS][GAMMA]*arg[LIMITS][LENGTH]*res[VELOCITY_BEFORE][i*width]<=arg[LIMITS][ROUNDING])
      state[i] = ACTIVE;
    speed = fabs(res[VELOCITY_FREE][i*width] - res[VELOCITY_BEFORE][i*width]);
    if (!(speed<=forced)) forced = speed;
    for (a=i*width; a<i*width+linear; ++a) {
      if (!(fabs(res[VELOCITY_BEFORE][a])<=fastest)) fastest = fabs(res[VELOCITY_BEFORE][a]);
      if (!(fabs(res[VELOCITY_FREE][a])<=fastest)) fastest = fabs(res[VELOCITY_FREE][a]);
    }
  }
  sizes[OPENS] = arg[LIMITS][PROJECTS]>0 && forced>arg[SHARES][NEWTON_SHARE]*arg[LIMITS][TOLERANCE]*fastest;
  res[STATUS][FORCED] = forced;
}
/* store the contacts of other features, where the shapes are at the start of the step; 1 if there are more
   contacts than memory */
static int casadi_store_others(const casadi_real** arg, casadi_real** res, casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[SIZES];
  const int* contact = (const int*) res[OTHER_DESCRIPTIONS];
  casadi_real gap, direction[9], point[3];
  casadi_int i, count = sizes[OTHERS];
  sizes[OTHERS] = 0;
  if (sizes[STORED]+count>iw[MAX_CONTACTS]) return 1;
  iw[CONTACTS] = 0;
  ((int*) arg[DIRECTION_ROWS])[0] = 0;
  casadi_all_axes(arg, iw);
  for (i=0; i<count; ++i, contact+=6) {
    gap = casadi_described_gap(arg, iw, contact, direction, point);
    casadi_add_contact(arg, res, iw, contact, ((const casadi_int*) res[OTHER_KEYS])[i], gap, direction,
      point);
  }
  casadi_take_middle(arg, res, iw);
  casadi_store(arg, res, iw, JOINS);
  sizes[ADDED] = count;
  return 0;
}
/* the stored contacts that are active or about to be added, with initial impulses by their keys */
static void casadi_gather(const casadi_real** arg, casadi_real** res, casadi_int* iw) {
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  const casadi_int* last = (const casadi_int*) arg[LAST_KEYS];
  const casadi_int* keys = (const casadi_int*) res[STORED_KEYS];
  const int* stored = (const int*) res[STORED_ROWS];
  const int* law = (const int*) arg[LAW_OF_PAIR];
  const int* contact;
  int* table = (int*) arg[KEY_TABLE];
  int* row = (int*) arg[DIRECTION_ROWS];
  casadi_int width = iw[COMPONENTS], groups = iw[GROUPS], i, j, a, g, n, r, s, next, slot;
  casadi_index(table, sizes[SLOTS], last, sizes[LAST_IMPULSES]);
  iw[CONTACTS] = 0;
  row[0] = 0;
  for (i=0; i<sizes[STORED]; ++i) {
    if (((const int*) res[STATES])[i]<ACTIVE) continue;
    n = iw[CONTACTS];
    iw[CONTACTS] = n + 1;
    contact = (const int*) res[STORED_DESCRIPTIONS] + 6*i;
    slot = table[casadi_slot(table, sizes[SLOTS], last, keys[i])];
    for (a=0; a<width; ++a) {
      r = n*width + a;
      s = i*width + a;
      next = row[r];
      for (j=stored[s]; j<stored[s+1]; ++j, ++next) {
        ((casadi_real*) arg[DIRECTIONS])[next] = res[STORED_DIRECTIONS][j];
        ((int*) arg[DIRECTION_COLUMNS])[next] = ((const int*) res[STORED_COLUMNS])[j];
      }
      row[r+1] = next;
      res[VELOCITY_BEFORE][r] = res[STORED_BEFORE][s];
      res[VELOCITY_FREE][r] = res[STORED_FREE][s];
      res[VELOCITY_APPLIED][r] = res[STORED_FREE][s];
      res[IMPULSE][r] = slot<0 ? 0.0 : res[LAST_IMPULSES][slot*width+a];
    }
    ((casadi_real*) arg[GAPS])[n] = res[STORED_GAPS][i];
    res[GAPS][n] = res[STORED_GAPS][i];
    ((casadi_int*) arg[KEYS])[n] = keys[i];
    ((int*) res[START_DIRECTIONS])[n] = ((const int*) res[STORED_START])[i];
    ((int*) res[PAIRS])[n] = contact[PAIR];
    for (a=0; a<6; ++a) ((int*) arg[DESCRIPTIONS])[6*n+a] = contact[a];
    for (g=0; g<groups; ++g) {
      ((casadi_real*) arg[FRICTION])[n*groups+g] = arg[LAWS][law[contact[PAIR]]*(2+groups)+2+g];
    }
    casadi_response_rows(arg, res, iw, n, contact[SHAPE], contact[OTHER_SHAPE]);
  }
}
/* change a state of stored contacts into another one */
static void casadi_exchange(casadi_real** res, casadi_int count, int old, int other) {
  int* state = (int*) res[STATES];
  casadi_int i;
  for (i=0; i<count; ++i) {
    if (state[i]==old) state[i] = other;
  }
}
/* gather the contacts with those about to be added; without contacts that open faster than forces change
   speeds if one has an impact. The outcome */
static casadi_int casadi_join(const casadi_real** arg, casadi_real** res, casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[SIZES];
  int* state = (int*) res[STATES];
  casadi_int i, impact = 0;
  casadi_real limits[2];
  casadi_gather(arg, res, iw);
  if (sizes[FINAL]) return DONE;
  sizes[FINAL] = 1;
  casadi_changes(arg, res, iw);
  for (i=0; i<iw[CONTACTS]; ++i) {
    if (res[VELOCITY_BEFORE][i*iw[COMPONENTS]]<0 && casadi_strikes(arg, res, iw, i)) impact = 1;
  }
  if (!impact) return DONE;
  casadi_largest(arg, res, iw, limits);
  for (i=0; i<sizes[STORED]; ++i) {
    if (state[i]!=JOINS || res[STORED_BEFORE][i*iw[COMPONENTS]]<=arg[SHARES][SLOW]*limits[0]) continue;
    state[i] = IDLE;
    --sizes[ADDED];
  }
  if (sizes[ADDED]==0) return UNCHANGED;
  casadi_gather(arg, res, iw);
  return DONE;
}
