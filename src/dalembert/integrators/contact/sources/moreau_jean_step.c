/* One step of free bodies with balls, hulls and walls by the scheme of Moreau and Jean, and gaps at its
   end */
/* whether the residual of the impulses may give energy to the bodies, as in elastic impacts: some contact
   closes faster than forces change speeds, and the contacts dissipate no more than by the residual */
static int casadi_may_gain(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real forced) {
  casadi_int i, r, rows = iw[CONTACTS]*iw[COMPONENTS], impact = 0;
  casadi_real loss = 0, push = 0;
  for (r=0; r<rows; ++r) {
    loss -= 0.5*res[IMPULSE][r]*(res[VELOCITY][r] + res[VELOCITY_BEFORE][r]);
    push += fabs(res[IMPULSE][r]);
  }
  for (i=0; i<iw[CONTACTS]; ++i) {
    if (-res[VELOCITY_BEFORE][i*iw[COMPONENTS]]>arg[SHARES][SLOW]*forced) impact = 1;
  }
  return impact && loss<=2*res[STATUS][RESIDUAL]*push;
}
/* two more steps of Newton's method, if they reduce the residual */
static void casadi_refine(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real tolerance) {
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], most = iw[MAX_ITERATIONS], r;
  casadi_real least = casadi_keep(res, rows, 1e300);
  iw[MAX_ITERATIONS] = 2;
  if (!(casadi_newton(arg, res, iw, w, tolerance)<=least)) {
    for (r=0; r<rows; ++r) res[IMPULSE][r] = res[BEST_IMPULSE][r];
    res[STATUS][RESIDUAL] = least;
  }
  iw[MAX_ITERATIONS] = most;
  casadi_velocities(arg, res, iw);
}
/* impulses of all contacts by Newton's law of impact; contacts that part do no work if positions are
   corrected. The number of proximal problems, or -1 if they did not converge */
static casadi_int casadi_newton_impulses(const casadi_real** arg, casadi_real** res,
    casadi_int* iw, casadi_real* w) {
  const casadi_real* before = res[VELOCITY_BEFORE];
  const casadi_real* law;
  casadi_real limits[2], scale;
  casadi_int i, a, r, more, rounds = 0, width = iw[COMPONENTS],
    linear = iw[GROUPS]>0 ? ((const int*) arg[GROUP_STARTS])[1] : 1;
  casadi_largest(arg, res, iw, limits);
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    law = arg[LAWS] + ((const int*) arg[LAW_OF_PAIR])[((const int*) res[PAIRS])[i]]*(2 + iw[GROUPS]);
    res[OFFSETS][r] = law[0]*before[r];
    if (arg[LIMITS][PROJECTS]>0 && before[r]>res[OFFSETS][r]) res[OFFSETS][r] = before[r];
    for (a=1; a<width; ++a) res[OFFSETS][r+a] = a<linear ? law[1]*before[r+a] : 0.0;
  }
  casadi_begin_impulses(arg, res, iw, w);
  casadi_sliding(arg, res, iw);
  scale = limits[1]>0 ? limits[1] : 1.0;
  do {
    more = casadi_impulses(arg, res, iw, w, scale);
    rounds = more<0 ? -1 : rounds + more;
  } while (rounds>=0 && casadi_stopping(arg, res, iw));
  if (rounds>=0 && casadi_may_gain(arg, res, iw, limits[0])) {
    casadi_refine(arg, res, iw, w, 1e-3*arg[SHARES][NEWTON_SHARE]*arg[LIMITS][TOLERANCE]*limits[1]);
  }
  return rounds;
}
/* distance by which the linear part of a stored gap closes in the step */
static casadi_real casadi_closing(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_int i) {
  const int* row = (const int*) res[STORED_ROWS];
  const int* column = (const int*) res[STORED_COLUMNS];
  casadi_int r = i*iw[COMPONENTS];
  casadi_real after = res[STORED_FREE][r]
    + casadi_row(res[STORED_DIRECTIONS], column, row[r], row[r+1], res[END_SPEEDS])
    - casadi_row(res[STORED_DIRECTIONS], column, row[r], row[r+1], res[FIRST_SPEEDS]);
  return -arg[LIMITS][LENGTH]/2*(res[STORED_BEFORE][r] + after);
}
/* whether the shapes of a contact that closes may pass through each other */
static int casadi_closes(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int i) {
  casadi_real closing = casadi_closing(arg, res, iw, i);
  return closing>arg[LIMITS][ROUNDING] && closing - res[STORED_GAPS][i]>arg[LIMITS][ROUNDING];
}
/* whether a stored gap would close by its rate at the start, though it is open there */
static int casadi_approaches(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int i) {
  return res[STORED_GAPS][i]>arg[LIMITS][ROUNDING]
    && res[STORED_GAPS][i] + arg[LIMITS][LENGTH]*res[STORED_BEFORE][i*iw[COMPONENTS]]<-arg[LIMITS][ROUNDING];
}
/* whether a contact with the shapes of a stored one presses */
static int casadi_pair_presses(const casadi_real** arg, casadi_real** res, casadi_int i) {
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  const casadi_int* last = (const casadi_int*) arg[LAST_KEYS];
  const int* contact = (const int*) res[STORED_DESCRIPTIONS];
  casadi_int j, k;
  for (j=0; j<sizes[STORED]; ++j) {
    if (contact[6*j+PAIR]!=contact[6*i+PAIR]) continue;
    for (k=0; k<sizes[LAST_IMPULSES]; ++k) {
      if (last[k]==((const casadi_int*) res[STORED_KEYS])[j]) return 1;
    }
  }
  return 0;
}
/* whether the cubic by gaps and rates at both ends of the step is negative within it */
static int casadi_dips(casadi_real gap, casadi_real rate, casadi_real gap_after,
    casadi_real rate_after) {
  casadi_real s;
  for (s=0; s<=1; s+=0.015625) {
    if ((1 + 2*s)*(1 - s)*(1 - s)*gap + s*(1 - s)*(1 - s)*rate + s*s*(3 - 2*s)*gap_after
        - s*s*(1 - s)*rate_after<0) return 1;
  }
  return 0;
}
/* whether an impact along a stored normal at a speed has more than a share of the kinetic energy at the
   end */
static int casadi_energetic(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int i, casadi_real speed, casadi_real share) {
  const int* row = (const int*) arg[INERTIA_ROWS];
  const int* start = (const int*) arg[BODY_STARTS];
  const int* contact = (const int*) res[STORED_DESCRIPTIONS] + 6*i;
  const casadi_real* v = arg[SPEEDS];
  const casadi_real* normal = res[STORED_DIRECTIONS] + ((const int*) res[STORED_ROWS])[i*iw[COMPONENTS]];
  const casadi_real* inverse;
  casadi_int j, k, c, s, body, size;
  casadi_real energy = 0, mobility = 0;
  for (j=0; j<iw[SPEEDS]; ++j) {
    energy += 0.5*v[j]*casadi_row(arg[INERTIA], (const int*) arg[INERTIA_COLUMNS], row[j], row[j+1], v);
  }
  for (s=1; s<4; s+=2) {
    body = ((const int*) arg[BODY_OF_SHAPE])[contact[s]];
    if (body<0) continue;
    size = start[body+1] - start[body];
    inverse = res[INVERSES] + body*iw[BLOCK_SIZE]*iw[BLOCK_SIZE];
    for (k=0; k<size; ++k) {
      for (c=0; c<size; ++c) mobility += normal[k]*inverse[k*size+c]*normal[c];
    }
    normal += size;
  }
  return 0.5*speed*speed>share*energy*mobility;
}
/* whether a stored gap closes and opens again within the step, as the contact e at the end does: by the
   speeds at both ends, and by the displacement, with directions at the start that follow from those in the
   middle. The energy of the impact is not negligible at twice the speed */
static int casadi_returns(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int i, casadi_int e) {
  const int* row = (const int*) res[STORED_ROWS];
  const int* w_row = (const int*) arg[DIRECTION_ROWS];
  casadi_int r = i*iw[COMPONENTS], q = e*iw[COMPONENTS];
  casadi_real gap = res[STORED_GAPS][i], after = arg[GAPS][e], h = arg[LIMITS][LENGTH], rate, rate_after;
  if (after<0 || res[VELOCITY_BEFORE][q]<=0
      || !casadi_dips(gap, h*res[STORED_BEFORE][r], after, h*res[VELOCITY_BEFORE][q])) return 0;
  if (((const casadi_int*) arg[KEYS])[e]!=((const casadi_int*) res[STORED_KEYS])[i]) return 1;
  rate = casadi_row(res[STORED_DIRECTIONS], (const int*) res[STORED_COLUMNS], row[r], row[r+1],
    res[DISPLACEMENT]);
  rate_after = casadi_row(arg[DIRECTIONS], (const int*) arg[DIRECTION_COLUMNS], w_row[q], w_row[q+1],
    res[DISPLACEMENT]);
  if (!((const int*) res[STORED_START])[i] && arg[LIMITS][THETA]!=1) rate = 2*rate - rate_after;
  return casadi_dips(gap, rate, after, rate_after)
    && casadi_energetic(arg, res, iw, i, 2*rate/h, arg[LIMITS][MISSED_ENERGY]);
}
/* whether the shapes of a stored contact may have an impact within the step that it misses: the normal of
   the nearest contact at the end is the opposite one, or a gap without impulses returns */
static int casadi_missed(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int i, int closes, int approaches) {
  const int* contact = (const int*) arg[DESCRIPTIONS];
  casadi_int e, nearest = -1;
  casadi_real normal[3];
  for (e=0; e<iw[CONTACTS]; ++e) {
    if (contact[6*e+PAIR]!=((const int*) res[STORED_DESCRIPTIONS])[6*i+PAIR]) continue;
    if (nearest<0 || arg[GAPS][e]<arg[GAPS][nearest]) nearest = e;
  }
  if (nearest<0) return 0;
  casadi_signed_normal(arg, iw, contact + 6*nearest, normal);
  if (closes && casadi_dot(normal, res[STORED_NORMALS] + 3*i)<0) return 1;
  return approaches && casadi_returns(arg, res, iw, i, nearest)
    && !casadi_pair_presses(arg, res, i);
}
/* select stored contacts to be added: those that are closed at the end, and those at rest that a correction
   would open; without any, those of other features that are closed */
static void casadi_select(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[SIZES];
  const casadi_int* keys = (const casadi_int*) arg[KEYS];
  const casadi_int* stored = (const casadi_int*) res[STORED_KEYS];
  int* state = (int*) res[STATES];
  casadi_int i, e, a, r;
  casadi_real forced = res[STATUS][FORCED], h = arg[LIMITS][LENGTH];
  for (i=0; i<sizes[STORED]; ++i) {
    if (state[i]!=IDLE) continue;
    r = i*iw[COMPONENTS];
    if (res[STORED_GAPS][i]<=h*forced/2 && fabs(res[STORED_BEFORE][r])<=arg[SHARES][SLOW]*forced
        && -casadi_closing(arg, res, iw, i)<=arg[LIMITS][ROUNDING]) state[i] = JOINS;
    for (e=0; e<iw[CONTACTS] && state[i]==IDLE; ++e) {
      if (keys[e]==stored[i] && arg[GAPS][e]<-arg[LIMITS][ROUNDING]) state[i] = JOINS;
    }
    if (state[i]==JOINS) ++sizes[ADDED];
  }
  for (e=0; e<iw[CONTACTS] && sizes[ADDED]==0; ++e) {
    if (!(arg[GAPS][e]<-arg[LIMITS][ROUNDING])) continue;
    for (i=0; i<sizes[STORED] && !(stored[i]==keys[e] && state[i]==ACTIVE); ++i) {}
    if (i<sizes[STORED]) continue;
    ((casadi_int*) res[OTHER_KEYS])[sizes[OTHERS]] = keys[e];
    for (a=0; a<6; ++a) ((int*) res[OTHER_DESCRIPTIONS])[6*sizes[OTHERS]+a] =
        ((const int*) arg[DESCRIPTIONS])[6*e+a];
    ++sizes[OTHERS];
  }
}
/* gaps at the end of the step, where the shapes are: the smallest one in res[STATUS][DEEPEST], the contacts
   that are added, and whether shapes may have an impact that the step misses; the outcome */
static casadi_int casadi_check_end(const casadi_real** arg, casadi_real** res, casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[SIZES];
  casadi_int i;
  int closes = 0, one, other;
  casadi_real reach[2];
  reach[0] = 0;
  reach[1] = 0;
  for (i=0; i<sizes[STORED] && !closes; ++i) {
    closes = casadi_closes(arg, res, iw, i) || casadi_approaches(arg, res, iw, i);
  }
  if (closes) casadi_fastest(arg, iw, res[DISPLACEMENT], reach);
  for (i=0; i<2; ++i) {
    reach[i] = 2*reach[i];
    if (reach[i]>res[STATUS][REACH]) res[STATUS][REACH] = reach[i];
  }
  if (!casadi_listed(arg, iw, reach[0]>reach[1] ? reach[0] : reach[1])) return OUTDATED;
  res[STATUS][DEEPEST] = casadi_contacts(arg, res, iw, reach);
  if (iw[CONTACTS]>iw[MAX_CONTACTS]) return MORE;
  sizes[ADDED] = 0;
  sizes[MISSES] = 0;
  sizes[FINAL] = 0;
  sizes[OTHERS] = 0;
  casadi_exchange(res, sizes[STORED], JOINS, ACTIVE);
  for (i=0; i<sizes[STORED] && closes && !sizes[MISSES]; ++i) {
    one = casadi_closes(arg, res, iw, i);
    other = casadi_approaches(arg, res, iw, i);
    if (one || other) sizes[MISSES] = casadi_missed(arg, res, iw, i, one, other);
  }
  if (res[STATUS][DEEPEST]>=-arg[LIMITS][ROUNDING]) return DONE;
  if (sizes[OPENS]) casadi_select(arg, res, iw);
  return CLOSED;
}
/* a call, by sizes[CALL]; iw[OUTCOME] is its outcome, CLOSED only of a gap at the end */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w,
    int mem) {
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  const casadi_real* last;
  casadi_real deepest[1];
  casadi_int j, r, rounds = 0, call = sizes[CALL], joins = call==JOINED || call==PARTED;
  if (call>=AT_END) {
    iw[OUTCOME] = call==AT_END ? casadi_check_end(arg, res, iw) : casadi_correct(arg, res, iw, w);
    return 0;
  }
  last = res[RECORD] + 6*(joins ? iw[RECORDED_STEPS] - 1 : iw[RECORDED_STEPS]);
  iw[OUTCOME] = SINGULAR;
  if (casadi_free_speeds(arg, res, iw, w)) return 0;
  iw[OUTCOME] = DONE;
  deepest[0] = last[DEPTH];
  if (call==AGAIN) casadi_other_forces(arg, res, iw);
  if (call==JOINED && sizes[OTHERS]>0 && casadi_store_others(arg, res, iw)) iw[OUTCOME] = MORE;
  if (call==JOINED && iw[OUTCOME]==DONE) iw[OUTCOME] = casadi_join(arg, res, iw);
  if (call==PARTED) {
    casadi_exchange(res, sizes[STORED], JOINS, IDLE);
    casadi_gather(arg, res, iw);
  }
  if (call==STEP) {
    iw[OUTCOME] = casadi_prepare(arg, res, iw, 1.5, deepest);
    if (iw[OUTCOME]) return 0;
    if (iw[RECORDED_CONTACTS]+iw[CONTACTS]>iw[MAX_RECORDED]) iw[OUTCOME] = FULL;
    casadi_store_all(arg, res, iw);
    casadi_gather(arg, res, iw);
  }
  if (iw[OUTCOME]) return 0;
  iw[OUTCOME] = UNORDERED;
  if (call!=AGAIN && casadi_contact_places(arg, res, iw)) return 0;
  iw[OUTCOME] = UNSOLVED;
  for (j=0; j<iw[SPEEDS]; ++j) res[SPEED_CHANGES][j] = 0;
  if (iw[CONTACTS]>0) rounds = casadi_newton_impulses(arg, res, iw, w);
  if (rounds<0) return 0;
  res[STATUS][EXCHANGED] = 0;
  res[STATUS][PUSHES] = 0;
  for (r=0; r<iw[CONTACTS]*iw[COMPONENTS]; ++r) {
    res[STATUS][EXCHANGED] += res[IMPULSE][r]*(res[VELOCITY][r] - res[VELOCITY_APPLIED][r]);
    res[STATUS][PUSHES] += fabs(res[IMPULSE][r]);
  }
  if (joins) {
    iw[RECORDED_CONTACTS] -= last[PRESSING];
    --iw[RECORDED_STEPS];
  }
  if (casadi_finish(arg, res, iw, deepest[0], rounds)) return 0;
  for (j=0; j<iw[SPEEDS]; ++j) res[END_SPEEDS][j] = res[FREE_SPEEDS][j];
  iw[OUTCOME] = DONE;
  return 0;
}
