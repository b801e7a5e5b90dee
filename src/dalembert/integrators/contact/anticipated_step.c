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
/* velocity offsets by Newton's law of impact, and the largest change of a normal speed by forces
   and the largest speed in limits */
static void casadi_first_offsets(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real* limits) {
  const casadi_real* before = res[24];
  const casadi_real* free = res[25];
  const int* law = (const int*) arg[33];
  const int* pair = (const int*) res[23];
  const int* group = (const int*) arg[13];
  casadi_int i, a, r, width = iw[1], linear = iw[2]>0 ? group[1] : 1, laws = 2 + iw[2];
  const int* row = (const int*) arg[9];
  const int* column = (const int*) arg[10];
  casadi_real h = arg[36][0], longest = arg[36][8], restitution, margin, room, turning;
  int fast;
  limits[0] = 0;
  limits[1] = 0;
  casadi_changes(arg, res, iw);
  for (i=0; i<iw[0]; ++i) {
    r = i*width;
    if (!(fabs(free[r] - before[r])<=limits[0])) limits[0] = fabs(free[r] - before[r]);
    for (a=0; a<linear; ++a) {
      if (!(fabs(before[r+a])<=limits[1])) limits[1] = fabs(before[r+a]);
      if (!(fabs(free[r+a])<=limits[1])) limits[1] = fabs(free[r+a]);
    }
  }
  for (i=0; i<iw[0]; ++i) {
    r = i*width;
    restitution = arg[28][law[pair[i]]*laws];
    for (a=1; a<width; ++a) {
      res[26][r+a] = a<linear ? arg[28][law[pair[i]]*laws+1]*before[r+a] : 0.0;
    }
    fast = casadi_strikes(arg, res, iw, i);
    room = fast ? restitution : 0.0;
    margin = casadi_margin(res[22][i], before[r], h, longest, room);
    turning = casadi_row(arg[0], column, row[r], row[r+1], arg[22]) - before[r];
    if (free[r]<margin && casadi_passes(res[22][i], before[r], free[r], turning, h, longest, room)) {
      margin = casadi_open(res[22][i], before[r], h);
    }
    if (free[r]<margin) {
      margin = casadi_bounce(res[22][i], before[r], h, longest, restitution, limits[0], arg[37][18],
        fast);
    }
    res[26][r] = -margin;
  }
}
/* offsets for the computed impulses; whether they changed. Velocities without offsets are in
   res[5] */
static int casadi_next_offsets(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real forced) {
  const casadi_real* before = res[24];
  const casadi_real* after = res[5];
  const casadi_real* impulse = res[0];
  const int* law = (const int*) arg[33];
  const int* pair = (const int*) res[23];
  casadi_real* offset = res[26];
  casadi_real* changed = res[27];
  casadi_int i, a, r, width = iw[1], rows = iw[0]*iw[1], differs = 0;
  casadi_real bounce, total = 0, magnitude = 0, work;
  int fast;
  for (r=0; r<rows; ++r) {
    changed[r] = offset[r];
    total += impulse[r]*(after[r] + before[r]);
    magnitude += fabs(impulse[r])*(fabs(after[r]) + fabs(before[r]));
  }
  for (i=0; i<iw[0]; ++i) {
    r = i*width;
    fast = casadi_strikes(arg, res, iw, i);
    bounce = casadi_bounce(res[22][i], before[r], arg[36][0], arg[36][8],
      arg[28][law[pair[i]]*(2+iw[2])], forced, arg[37][18], fast);
    if (impulse[r]>0 && -offset[r]<bounce && (before[r]<=0 || offset[r]!=before[r])) {
      changed[r] = -bounce;
    }
    if (!(total>arg[37][20]*magnitude)) continue;
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
/* impulses of all contacts; the number of proximal problems, or -1 if they did not converge */
static casadi_int casadi_impulses(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w) {
  casadi_real* velocity = (casadi_real*) arg[2];
  casadi_int rows = iw[0]*iw[1], r, k, rounds = 0;
  casadi_real limits[2], scale, allowed, residual;
  casadi_first_offsets(arg, res, iw, limits);
  scale = limits[1]>0 ? limits[1] : 1.0;
  for (r=0; r<rows; ++r) ((casadi_real*) arg[7])[r] = 0;
  casadi_mobilities(arg, res, iw);
  casadi_inertia_blocks(arg, res, iw);
  casadi_forget(w + iw[13] + rows + iw[11], iw[0]);
  for (k=0; k<iw[25]; ++k) {
    for (r=0; r<rows; ++r) velocity[r] = res[48][r] + res[26][r];
    rounds += casadi_solution(arg, res, iw, w, arg[36][1], scale);
    residual = res[11][1];
    allowed = arg[36][1]*casadi_size(arg, iw, res[0], scale);
    if (!(residual<=allowed) || residual>arg[37][21]*scale) return -1;
    casadi_shorten(arg, res[0], iw);
    casadi_respond(arg[1], (const int*) arg[11], (const int*) arg[12], res[0], rows, iw[3],
      res[10]);
    for (r=0; r<rows; ++r) {
      res[5][r] = res[48][r] + casadi_row(arg[0], (const int*) arg[10], ((const int*) arg[9])[r],
        ((const int*) arg[9])[r+1], res[10]);
    }
    if (!casadi_next_offsets(arg, res, iw, limits[0])) break;
  }
  res[11][1] = residual;
  return rounds;
}
/* record of the step: losses, residual, and keys, impulses and offsets of pressing contacts */
static void casadi_record(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real deepest, casadi_int rounds) {
  const casadi_int* key = (const casadi_int*) arg[43];
  casadi_int* last = (casadi_int*) arg[44];
  casadi_int* sizes = (casadi_int*) arg[47];
  casadi_int* keys = (casadi_int*) res[31];
  casadi_real* impulse = res[0];
  casadi_real* numbers = res[30] + 6*iw[20];
  casadi_int i, a, r, width = iw[1], rows = iw[0]*iw[1], pressing = 0;
  casadi_real loss = 0, friction = 0;
  for (i=0; i<iw[0]; ++i) {
    r = i*width;
    for (a=0; a<width; ++a) {
      loss -= 0.5*impulse[r+a]*(res[5][r+a] + res[24][r+a]);
      if (a>0) friction -= 0.5*impulse[r+a]*(res[5][r+a] + res[24][r+a]);
    }
    if (!(impulse[r]>0)) continue;
    last[pressing] = key[i];
    keys[iw[21]+pressing] = key[i];
    ((int*) res[46])[iw[21]+pressing] = ((const int*) res[45])[i];
    for (a=0; a<width; ++a) {
      res[29][pressing*width+a] = impulse[r+a];
      res[32][(iw[21]+pressing)*width+a] = impulse[r+a];
      res[33][(iw[21]+pressing)*width+a] = res[26][r+a];
    }
    ++pressing;
  }
  numbers[0] = deepest;
  numbers[1] = loss;
  numbers[2] = friction;
  numbers[3] = rows>0 ? res[11][1] : 0.0;
  numbers[4] = rounds;
  numbers[5] = pressing;
  sizes[0] = pressing;
  sizes[8] = iw[0];
  for (i=0; i<iw[0]; ++i) {
    ((casadi_int*) arg[57])[i] = key[i];
    for (a=0; a<6; ++a) ((int*) arg[58])[6*i+a] = ((const int*) arg[51])[6*i+a];
  }
  iw[21] += pressing;
  ++iw[20];
}
/* other forces of the same step: its responses, and the velocities at its end without impulses */
static void casadi_other_forces(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const int* contact = (const int*) arg[51];
  const int* row = (const int*) arg[9];
  casadi_int i, j, r;
  for (j=0; j<iw[3]; ++j) res[10][j] = res[19][j] - res[49][j];
  for (i=0; i<iw[0]; ++i, contact+=6) casadi_response_rows(arg, res, iw, i, contact[1], contact[3]);
  for (r=0; r<iw[0]*iw[1]; ++r) {
    res[48][r] = res[25][r]
      + casadi_row(arg[0], (const int*) arg[10], row[r], row[r+1], res[10]);
  }
}
/* contacts of a step, with the velocities that it has without impulses, also in res[48], and the speeds
   in res[49]; the outcome */
static casadi_int casadi_prepare(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* deepest) {
  casadi_real* v = (casadi_real*) arg[22];
  casadi_real h = arg[36][0], reach[2];
  casadi_int j, r;
  reach[0] = 0;
  reach[1] = 0;
  casadi_fastest(arg, iw, v, reach);
  casadi_fastest(arg, iw, res[19], reach);
  for (j=0; j<2; ++j) reach[j] = arg[37][17]*h*reach[j];
  res[11][3] = reach[0]>reach[1] ? reach[0] : reach[1];
  if (!casadi_listed(arg, iw, res[11][3])) return 2;
  deepest[0] = casadi_contacts(arg, res, iw, reach);
  if (iw[0]>iw[19]) return 7;
  casadi_take_middle(arg, res, iw);
  for (r=0; r<iw[0]*iw[1]; ++r) res[48][r] = res[25][r];
  for (j=0; j<iw[3]; ++j) res[49][j] = res[19][j];
  if (((const casadi_int*) arg[47])[6]==2) return 0;
  if (iw[21]+iw[0]>iw[22]) return 3;
  if (!(deepest[0]>=-arg[36][2])) return 4;
  return casadi_contact_places(arg, res, iw) ? 5 : 0;
}
/* a step; iw[6] is its outcome: 0 done, 1 singular inertia, 2 the list is outdated, 3 more
   contacts than memory of the record, 4 a gap is closed, 5 the order of elimination misses a pair of
   bodies, 6 the impulses did not converge, 7 more contacts than memory */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w,
    int mem) {
  const int* start = (const int*) arg[30];
  casadi_real* v = (casadi_real*) arg[22];
  casadi_real* free = res[19];
  const casadi_real* last = res[30] + 6*iw[20];
  casadi_real h = arg[36][0], deepest[1];
  casadi_int j, rounds = 0, call = ((const casadi_int*) arg[47])[6];
  iw[6] = 0;
  if (call==1) {
    casadi_path(arg, res, iw);
    return 0;
  }
  iw[6] = 1;
  if (casadi_invert(arg, res, iw, w)) return 0;
  for (j=0; j<iw[3]; ++j) free[j] = v[j];
  casadi_accelerate(res[20], start, iw[16], iw[9], h, arg[23], free);
  if (call==3) {
    casadi_other_forces(arg, res, iw);
    deepest[0] = last[0];
  } else {
    iw[6] = casadi_prepare(arg, res, iw, deepest);
    if (iw[6] || call==2) return 0;
  }
  iw[6] = 6;
  for (j=0; j<iw[3]; ++j) res[10][j] = 0;
  if (iw[0]>0) rounds = casadi_impulses(arg, res, iw, w);
  if (rounds<0) return 0;
  if (call==3) rounds += last[4];
  for (j=0; j<iw[3]; ++j) {
    free[j] += res[10][j];
    if (!(fabs(free[j])<1e300)) return 0;
  }
  casadi_record(arg, res, iw, deepest[0], rounds);
  for (j=0; j<iw[3]; ++j) {
    res[28][j] = h*(0.5*free[j] + 0.5*v[j]);
    v[j] = free[j];
  }
  iw[6] = 0;
  return 0;
}
