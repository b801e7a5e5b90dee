/* One step of free bodies with balls, hulls and walls by the scheme of anticipated impacts */
/* minimum speed that leaves a gap open */
static casadi_real casadi_open(casadi_real gap, casadi_real before, casadi_real h) {
  return -2*gap/h - before;
}
/* minimum speed that permits an impact in the next step, which may have the longest length */
static casadi_real casadi_margin(casadi_real gap, casadi_real before, casadi_real h,
    casadi_real longest, casadi_real restitution) {
  casadi_real margin = -((gap>0 ? gap : 0.0) + h*before/2)*2/(h + (1 - restitution)*longest);
  casadi_real open = casadi_open(gap, before, h);
  return margin>open ? margin : open;
}
/* whether a gap needs no room for an impact: as its directions turn, it remains open without impulses
   for the time that it would take */
static int casadi_passes(casadi_real gap, casadi_real before, casadi_real free, casadi_real turning,
    casadi_real h, casadi_real longest, casadi_real restitution) {
  casadi_real ahead = (1 - restitution)*longest/2;
  gap = (gap>0 ? gap : 0.0) + h*(before + free)/2;
  return turning>0 && gap + ahead*(free + ahead*turning/h)>=0;
}
/* minimum speed of a contact under pressure: impacting, resting or separating; between the latter if it
   approaches more slowly than at rest */
static casadi_real casadi_bounce(casadi_real gap, casadi_real before, casadi_real h,
    casadi_real longest, casadi_real restitution, casadi_real forced, casadi_real closing, int fast) {
  casadi_real gradual = gap>0 ? closing*gap/h : 0.0, open = casadi_open(gap, before, h);
  casadi_real speed = casadi_margin(gap, before, h, longest, 0.0), share, reversed, parting;
  share = before>0 ? 1.0 : (before>-gradual ? 1 + before/gradual : 0.0);
  reversed = before>0 ? -before : 0.0;
  parting = (1 - restitution)*speed + restitution*(speed<reversed ? reversed : speed);
  if (gradual>forced) gradual = forced;
  if (speed<-gradual) speed = -gradual;
  speed = (1 - share)*speed + share*parting;
  if (before<0 && fast) speed = -restitution*before;
  return speed>open ? speed : open;
}
/* velocity offsets by Newton's law of impact, for the largest change of a normal speed by forces */
static void casadi_first_offsets(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real forced) {
  const casadi_real* before = res[VELOCITY_BEFORE];
  const casadi_real* free = res[VELOCITY_FREE];
  const int* law = (const int*) arg[LAW_OF_PAIR];
  const int* pair = (const int*) res[PAIRS];
  const int* group = (const int*) arg[GROUP_STARTS];
  casadi_int i, a, r, width = iw[COMPONENTS], linear = iw[GROUPS]>0 ? group[1] : 1, laws = 2 + iw[GROUPS];
  const int* row = (const int*) arg[DIRECTION_ROWS];
  const int* column = (const int*) arg[DIRECTION_COLUMNS];
  casadi_real h = arg[LIMITS][LENGTH], longest = arg[LIMITS][LONGEST], restitution, margin, room, turning;
  int fast;
  casadi_changes(arg, res, iw);
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    restitution = arg[LAWS][law[pair[i]]*laws];
    for (a=1; a<width; ++a) {
      res[OFFSETS][r+a] = a<linear ? arg[LAWS][law[pair[i]]*laws+1]*before[r+a] : 0.0;
    }
    fast = casadi_strikes(arg, res, iw, i);
    room = fast ? restitution : 0.0;
    margin = casadi_margin(res[GAPS][i], before[r], h, longest, room);
    turning = casadi_row(arg[DIRECTIONS], column, row[r], row[r+1], arg[SPEEDS]) - before[r];
    if (free[r]<margin && casadi_passes(res[GAPS][i], before[r], free[r], turning, h, longest, room)) {
      margin = casadi_open(res[GAPS][i], before[r], h);
    }
    if (free[r]<margin) {
      margin = casadi_bounce(res[GAPS][i], before[r], h, longest, restitution, forced, arg[SHARES][CLOSING],
        fast);
    }
    res[OFFSETS][r] = -margin;
  }
}
/* offsets of the contacts that rough impulses press; their largest change */
static casadi_real casadi_pressed_offsets(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real forced, casadi_real least) {
  const int* law = (const int*) arg[LAW_OF_PAIR];
  const int* pair = (const int*) res[PAIRS];
  casadi_int i, r;
  casadi_real bounce, change, largest = 0;
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*iw[COMPONENTS];
    if (!(res[IMPULSE][r]*arg[MOBILITY][r]>least)) continue;
    bounce = casadi_bounce(res[GAPS][i], res[VELOCITY_BEFORE][r], arg[LIMITS][LENGTH], arg[LIMITS][LONGEST],
      arg[LAWS][law[pair[i]]*(2+iw[GROUPS])], forced, arg[SHARES][CLOSING], casadi_strikes(arg, res, iw, i));
    change = bounce + res[OFFSETS][r];
    if (!(change>0)) continue;
    res[OFFSETS][r] = -bounce;
    if (change>largest) largest = change;
  }
  return largest;
}
/* offsets for the computed impulses; whether they changed. Velocities without offsets are in
   res[VELOCITY] */
static int casadi_next_offsets(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real forced) {
  const casadi_real* before = res[VELOCITY_BEFORE];
  const casadi_real* after = res[VELOCITY];
  const casadi_real* impulse = res[IMPULSE];
  const int* law = (const int*) arg[LAW_OF_PAIR];
  const int* pair = (const int*) res[PAIRS];
  casadi_real* offset = res[OFFSETS];
  casadi_real* changed = res[NEXT_OFFSETS];
  casadi_int i, a, r, width = iw[COMPONENTS], rows = iw[CONTACTS]*iw[COMPONENTS], differs = 0;
  casadi_real bounce, total = 0, magnitude = 0, work;
  int fast;
  for (r=0; r<rows; ++r) {
    changed[r] = offset[r];
    total += impulse[r]*(after[r] + before[r]);
    magnitude += fabs(impulse[r])*(fabs(after[r]) + fabs(before[r]));
  }
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    fast = casadi_strikes(arg, res, iw, i);
    bounce = casadi_bounce(res[GAPS][i], before[r], arg[LIMITS][LENGTH], arg[LIMITS][LONGEST],
      arg[LAWS][law[pair[i]]*(2+iw[GROUPS])], forced, arg[SHARES][CLOSING], fast);
    if (impulse[r]>0 && -offset[r]<bounce && (before[r]<=0 || offset[r]!=before[r])) {
      changed[r] = -bounce;
    }
    if (!(total>arg[SHARES][ROUNDING]*magnitude)) continue;
    work = 0;
    for (a=0; a<width; ++a) work += impulse[r+a]*(after[r+a] + before[r+a]);
    if (!(work>0)) continue;
    if (before[r]>changed[r]) changed[r] = before[r];
    for (a=1; a<width; ++a) changed[r+a] = before[r+a];
  }
  for (r=0; r<rows; ++r) {
    if (changed[r]!=offset[r]) differs = 1;
    offset[r] = changed[r];
  }
  return differs;
}
/* offsets of the contacts that pressed and slid in the last solution of the same step, whose means differ
   little; its record begins after that of the steps before */
static void casadi_repeated_offsets(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real forced) {
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  const casadi_int* keys = (const casadi_int*) res[RECORDED_KEYS] + iw[RECORDED_CONTACTS];
  const casadi_real* numbers = res[RECORD] + 6*iw[RECORDED_STEPS];
  const casadi_real* before = res[VELOCITY_BEFORE];
  const casadi_real* last;
  int* table = (int*) arg[KEY_TABLE];
  casadi_int i, slot, r, width = iw[COMPONENTS], pressing = (casadi_int) numbers[PRESSING];
  casadi_real stops;
  casadi_pressed_offsets(arg, res, iw, forced, 0.0);
  if (pressing>=sizes[SLOTS]) return;
  casadi_index(table, sizes[SLOTS], keys, pressing);
  for (i=0; i<iw[CONTACTS]; ++i) {
    if (!((const int*) res[SLIDING])[i]) continue;
    slot = table[casadi_slot(table, sizes[SLOTS], keys, ((const casadi_int*) arg[KEYS])[i])];
    if (slot<0) continue;
    r = i*width;
    last = res[RECORDED_OFFSETS] + (iw[RECORDED_CONTACTS] + slot)*width;
    stops = arg[LAWS][((const int*) arg[LAW_OF_PAIR])[((const int*) res[PAIRS])[i]]*(2+iw[GROUPS])+1];
    if (fabs(last[1] - before[r+1]) + fabs(last[2] - before[r+2])
        <=fabs(last[1] - stops*before[r+1]) + fabs(last[2] - stops*before[r+2])) continue;
    ((int*) res[SLIDING])[i] = 0;
    res[OFFSETS][r+1] = stops*before[r+1];
    res[OFFSETS][r+2] = stops*before[r+2];
  }
}
/* offsets of the contacts that press and slide in rough impulses; the number of proximal problems */
static casadi_int casadi_rough_offsets(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real forced, casadi_real scale) {
  casadi_int k, rounds = 0;
  casadi_real rough = arg[SHARES][ROUGH]*scale;
  for (k=0; k<iw[MAX_OFFSETS]; ++k) {
    rounds += casadi_offset_impulses(arg, res, iw, w, arg[SHARES][ROUGH], scale);
    if (!(casadi_pressed_offsets(arg, res, iw, forced, rough)>rough)) break;
  }
  if (iw[DIMENSION]==3) {
    casadi_velocities(arg, res, iw);
    casadi_stopping(arg, res, iw);
  }
  return rounds;
}
/* impulses of all contacts, with offsets that depend on which of them press and slide: rough impulses, or
   those of the same step with other means, determine most of these. The number of proximal problems, or -1
   if they did not converge */
static casadi_int casadi_anticipated_impulses(const casadi_real** arg, casadi_real** res,
    casadi_int* iw, casadi_real* w, int again) {
  casadi_int k, more, rounds = 0;
  casadi_real limits[2], scale, residual;
  int changed;
  casadi_largest(arg, res, iw, limits);
  casadi_first_offsets(arg, res, iw, limits[0]);
  scale = limits[1]>0 ? limits[1] : 1.0;
  casadi_begin_impulses(arg, res, iw, w);
  casadi_sliding(arg, res, iw);
  if (again) casadi_repeated_offsets(arg, res, iw, limits[0]);
  else rounds = casadi_rough_offsets(arg, res, iw, w, limits[0], scale);
  for (k=0; k<iw[MAX_OFFSETS]; ++k) {
    if (k>0 && casadi_satisfies(arg, res, iw, w, scale)) more = 0;
    else more = casadi_impulses(arg, res, iw, w, scale);
    if (more<0) return -1;
    rounds += more;
    residual = res[STATUS][RESIDUAL];
    changed = casadi_next_offsets(arg, res, iw, limits[0]);
    if (!casadi_stopping(arg, res, iw) && !changed) break;
  }
  res[STATUS][RESIDUAL] = residual;
  return rounds;
}
/* a call, by sizes[CALL]; iw[OUTCOME] is its outcome */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w,
    int mem) {
  const casadi_real* last = res[RECORD] + 6*iw[RECORDED_STEPS];
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  casadi_real deepest[1];
  casadi_int j, rounds = 0, call = sizes[CALL];
  iw[OUTCOME] = DONE;
  if (call==ON_PATH) {
    casadi_path(arg, res, iw);
    return 0;
  }
  iw[OUTCOME] = SINGULAR;
  if (casadi_free_speeds(arg, res, iw, w)) return 0;
  if (call==AGAIN) {
    casadi_other_forces(arg, res, iw);
    deepest[0] = last[DEPTH];
  } else {
    iw[OUTCOME] = casadi_prepare(arg, res, iw, 1.0, deepest);
    if (iw[OUTCOME] || call==ALL) return 0;
    if (iw[RECORDED_CONTACTS]+iw[CONTACTS]>iw[MAX_RECORDED]) iw[OUTCOME] = FULL;
    else if (!(deepest[0]>=-arg[LIMITS][ROUNDING])) iw[OUTCOME] = CLOSED;
    else if (casadi_contact_places(arg, res, iw)) iw[OUTCOME] = UNORDERED;
    if (iw[OUTCOME]) return 0;
  }
  iw[OUTCOME] = UNSOLVED;
  for (j=0; j<iw[SPEEDS]; ++j) res[SPEED_CHANGES][j] = 0;
  if (iw[CONTACTS]>0) rounds = casadi_anticipated_impulses(arg, res, iw, w,
      call==AGAIN || sizes[PATH]>0);
  if (rounds<0) return 0;
  if (call==AGAIN) rounds += last[ROUNDS];
  if (!casadi_finish(arg, res, iw, deepest[0], rounds)) iw[OUTCOME] = DONE;
  return 0;
}
