/* Impulses of the contacts of free bodies: Newton's method, then few proximal problems, then interior
   points and proximal problems from these */
/* change of speed along a row of directions by a unit impulse along it; responses of coupled bodies
   have entries of other bodies, too */
static casadi_real casadi_own_response(const casadi_real** arg, casadi_int r) {
  const int* row = (const int*) arg[DIRECTION_ROWS];
  const int* column = (const int*) arg[DIRECTION_COLUMNS];
  const int* x_row = (const int*) arg[RESPONSE_ROWS];
  const int* x_column = (const int*) arg[RESPONSE_COLUMNS];
  casadi_int j, k, start = x_row[r] - row[r];
  casadi_real sum = 0;
  for (j=row[r]; j<row[r+1]; ++j) {
    k = j + start;
    if (k>=x_row[r+1] || x_column[k]!=column[j]) {
      for (k=x_row[r]; k<x_row[r+1] && x_column[k]!=column[j]; ++k) {}
    }
    if (k<x_row[r+1]) sum += arg[DIRECTIONS][j]*arg[RESPONSES][k];
  }
  return sum;
}
/* mobility and weights of the residual, with additions to the diagonal */
static void casadi_mobilities(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const casadi_real* shift = arg[SHIFT];
  casadi_real* mobility = (casadi_real*) arg[MOBILITY];
  casadi_real* weight = (casadi_real*) arg[WEIGHTS];
  const int* group = (const int*) arg[GROUP_STARTS];
  casadi_int width = iw[COMPONENTS], groups = iw[GROUPS], i, g, a, r, linear = iw[GROUPS]>0 ? group[1] : 1;
  casadi_real along;
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    for (a=0; a<width; ++a) mobility[r+a] = shift[r+a] + casadi_own_response(arg, r + a);
    if (!(mobility[r]>0)) mobility[r] = 1;
    for (g=0; g<groups; ++g) {
      along = 0;
      for (a=group[g]; a<group[g+1]; ++a) along += mobility[r+a];
      for (a=group[g]; a<group[g+1]; ++a) mobility[r+a] = along>0 ? along : mobility[r];
    }
    for (a=0; a<width; ++a) {
      weight[r+a] = a<linear ? mobility[r+a] : sqrt(mobility[r+a]*mobility[r]);
    }
  }
}
/* reference speed: the scale, or the largest change of speed of a contact by its impulse */
static casadi_real casadi_size(const casadi_real** arg, const casadi_int* iw,
    const casadi_real* impulse, casadi_real scale) {
  const int* group = (const int*) arg[GROUP_STARTS];
  casadi_int i, a, linear = iw[GROUPS]>0 ? group[1] : 1;
  casadi_real square;
  for (i=0; i<iw[CONTACTS]; ++i) {
    square = 0;
    for (a=0; a<linear; ++a) square += impulse[i*iw[COMPONENTS]+a]*impulse[i*iw[COMPONENTS]+a];
    square = sqrt(square)*arg[MOBILITY][i*iw[COMPONENTS]];
    if (square>scale) scale = square;
  }
  return scale;
}
/* residual after Newton's method with a tolerance */
static casadi_real casadi_newton(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real tolerance) {
  casadi_real* settings = (casadi_real*) arg[SETTINGS];
  settings[TOLERANCE] = tolerance;
  if (casadi_iterate(arg, res, iw, w)!=2) casadi_state(arg, res, iw, w);
  return res[STATUS][RESIDUAL];
}
/* the best impulses, those with the least residual, in res[BEST_IMPULSE] */
static casadi_real casadi_keep(casadi_real** res, casadi_int rows, casadi_real least) {
  casadi_int r;
  if (!(res[STATUS][RESIDUAL]<least)) return least;
  for (r=0; r<rows; ++r) res[BEST_IMPULSE][r] = res[IMPULSE][r];
  return res[STATUS][RESIDUAL];
}
/* least residual after interior points from the impulses in res[IMPULSE], at a share of the largest speed
   from the boundary, and Newton's method from these as often as the residual falls by a factor */
static casadi_real casadi_central(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real allowed, casadi_real largest, casadi_real start,
    casadi_real least) {
  casadi_int most = iw[MAX_ITERATIONS], rows = iw[CONTACTS]*iw[COMPONENTS], k, short_steps = 0;
  casadi_real limit = arg[SHARES][INTERIOR_SHARE]*largest, share;
  casadi_interior_start(arg, res, iw, largest, start, w);
  for (k=0; k<iw[MAX_INTERIOR] && short_steps<iw[MAX_SHORT_STEPS]; ++k) {
    casadi_interior_impulses(arg, res, iw, w);
    least = casadi_keep(res, rows, least);
    if (!(res[STATUS][RESIDUAL]<1e300) || least<=allowed) break;
    if (res[STATUS][RESIDUAL]<=limit) {
      limit = arg[SHARES][INTERIOR_FACTOR]*res[STATUS][RESIDUAL];
      iw[MAX_ITERATIONS] = iw[MAX_POLISHING];
      casadi_forget(w + iw[WORK] + rows + iw[MERITS], iw[CONTACTS]);
      casadi_newton(arg, res, iw, w, arg[SHARES][NEWTON_SHARE]*allowed);
      iw[MAX_ITERATIONS] = most;
      least = casadi_keep(res, rows, least);
      if (least<=allowed || least<arg[SHARES][INTERIOR_END]*largest) break;
      casadi_interior_impulses(arg, res, iw, w);
    }
    share = casadi_interior(arg, res, iw, w, largest);
    if (share<0) break;
    short_steps = share<arg[SHARES][SHORT] ? short_steps + 1 : 0;
  }
  return least;
}
/* the best impulses in res[IMPULSE] after interior points from these, and again from zero; the residual
 */
static casadi_real casadi_centered(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real allowed, casadi_real largest) {
  const int* group = (const int*) arg[GROUP_STARTS];
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], r;
  casadi_real least = casadi_keep(res, rows, 1e300);
  if (iw[GROUPS]>1 || (iw[GROUPS]==1 && group[1]!=iw[COMPONENTS])) return least;
  least = casadi_central(arg, res, iw, w, allowed, largest, arg[SHARES][FIRST_START], least);
  if (least>arg[SHARES][INTERIOR_END]*largest) {
    for (r=0; r<rows; ++r) res[IMPULSE][r] = 0;
    least = casadi_central(arg, res, iw, w, allowed, largest, arg[SHARES][SECOND_START], least);
  }
  for (r=0; r<rows; ++r) res[IMPULSE][r] = res[BEST_IMPULSE][r];
  casadi_forget(w + iw[WORK] + rows + iw[MERITS], iw[CONTACTS]);
  res[STATUS][RESIDUAL] = least;
  return least;
}
/* whether contacts are redundant: many pairs of bodies press at several points */
static int casadi_redundant(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const int* block = (const int*) res[ENTRY_STARTS];
  casadi_int i, pressing = 0, pairs = 0, last = -1;
  for (i=0; i<iw[CONTACTS]; ++i) {
    if (!(res[IMPULSE][i*iw[COMPONENTS]]>0)) continue;
    if (last<0 || block[i]!=block[last]) ++pairs;
    ++pressing;
    last = i;
  }
  return pressing>arg[SHARES][REDUNDANT]*pairs;
}
/* impulses that differ from the best ones by a pseudorandom share, up to a limit, and their residual */
static casadi_real casadi_varied(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, const casadi_real* best, casadi_real limit, casadi_real phase) {
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], r;
  for (r=0; r<rows; ++r) {
    phase += 0.61803398874989485;
    while (phase>=1) phase -= 1;
    res[IMPULSE][r] = best[r]*(1 + limit*(2*phase - 1));
  }
  casadi_forget(w + iw[WORK] + rows + iw[MERITS], iw[CONTACTS]);
  casadi_state(arg, res, iw, w);
  return res[STATUS][RESIDUAL];
}
/* at most a number of proximal problems from the impulses in res[IMPULSE]; their number, and the
   residual in status[RESIDUAL]. The best impulses are in res[IMPULSE]. Before interior points, last = 0, and
   above the residual at which these end, few problems are solved, or end where Newton's method fails. The
   weights fall more slowly after interior points, last = 1, and for redundant contacts, last = 2, after a
   failure. Solutions of successive problems then often move in the same direction, by lengths that are
   inverse to the weights: Newton's method begins where this leads to. Friction is no gradient, so that
   they may repeat a cycle: those of redundant contacts then begin again with other impulses */
static casadi_int casadi_proximal(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real share, casadi_real scale, casadi_int most, int last) {
  casadi_real* velocity = (casadi_real*) arg[VELOCITY];
  casadi_real* shift = (casadi_real*) arg[SHIFT];
  casadi_real* impulse = res[IMPULSE];
  casadi_real* original = res[PROXIMAL];
  casadi_real* center = original + iw[CONTACTS]*iw[COMPONENTS];
  casadi_real* best = center + iw[CONTACTS]*iw[COMPONENTS];
  casadi_real* move = best + iw[CONTACTS]*iw[COMPONENTS];
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], rounds, r, solved = 1, failed = 0, slow, idle = 0;
  casadi_real weight = arg[SHARES][WEIGHT], residual = res[STATUS][RESIDUAL], least = residual, tolerance,
    allowed;
  casadi_real ahead, moved = 0, halved = residual;
  for (r=0; r<rows; ++r) {
    original[r] = velocity[r];
    center[r] = impulse[r];
    best[r] = impulse[r];
    move[r] = 0;
  }
  for (rounds=0; rounds<most && residual<1e300; ++rounds) {
    allowed = share*casadi_size(arg, iw, best, scale);
    if (!(least>allowed)) break;
    if (!last && least>arg[SHARES][INTERIOR_END]*scale && (rounds>=iw[FEW_PROXIMAL] || failed)) break;
    slow = last==2 ? failed : last && rounds>2;
    ahead = slow || last==1 ? moved/weight : 0.0;
    for (r=0; r<rows; ++r) {
      shift[r] = weight*arg[MOBILITY][r];
      velocity[r] = original[r] - shift[r]*center[r];
      impulse[r] = center[r] + ahead*move[r];
    }
    casadi_mobilities(arg, res, iw);
    casadi_forget(w + iw[WORK] + rows + iw[MERITS], iw[CONTACTS]);
    tolerance = arg[SHARES][RESIDUAL_SHARE]*residual;
    if (arg[SHARES][TOLERANCE_SHARE]*allowed>tolerance) tolerance = arg[SHARES][TOLERANCE_SHARE]*allowed;
    solved = casadi_newton(arg, res, iw, w, tolerance)<=tolerance;
    moved = solved ? weight : 0.0;
    if (!solved) failed = 1;
    for (r=0; r<rows; ++r) {
      move[r] = impulse[r] - center[r];
      shift[r] = 0;
      velocity[r] = original[r];
    }
    weight = weight*(!solved ? arg[SHARES][INCREASE]
      : (slow ? arg[SHARES][LAST_DECREASE] : arg[SHARES][DECREASE]));
    if (weight>arg[SHARES][WEIGHT_MAX]) weight = arg[SHARES][WEIGHT_MAX];
    if (weight<arg[SHARES][WEIGHT_MIN]) weight = arg[SHARES][WEIGHT_MIN];
    casadi_mobilities(arg, res, iw);
    casadi_forget(w + iw[WORK] + rows + iw[MERITS], iw[CONTACTS]);
    if (solved || weight==arg[SHARES][WEIGHT_MAX]) {
      casadi_state(arg, res, iw, w);
      residual = res[STATUS][RESIDUAL];
      for (r=0; r<rows; ++r) {
        center[r] = impulse[r];
        if (residual<least) best[r] = impulse[r];
      }
      if (residual<least) least = residual;
    }
    idle = least<0.5*halved ? 0 : idle + 1;
    if (idle==0) halved = least;
    if (last==2 && idle>=arg[SHARES][PATIENCE]) {
      residual = casadi_varied(arg, res, iw, w, best, arg[SHARES][CHANGE], 1e-3*rounds);
      for (r=0; r<rows; ++r) center[r] = impulse[r];
      weight = arg[SHARES][WEIGHT];
      moved = 0;
      failed = 0;
      idle = 0;
    }
  }
  for (r=0; r<rows; ++r) impulse[r] = best[r];
  res[STATUS][RESIDUAL] = least;
  return rounds;
}
/* impulses from those in res[IMPULSE], with a tolerance relative to the scale or to a larger change of
   speed; the number of proximal problems, and the residual in status[RESIDUAL]. Redundant contacts have
   few of Newton's steps, then proximal problems with more of them */
static casadi_int casadi_solution(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real tolerance, casadi_real scale) {
  casadi_real allowed = tolerance*casadi_size(arg, iw, res[IMPULSE], scale);
  casadi_int rounds, usual = iw[MAX_ITERATIONS], first = (casadi_int) arg[SHARES][FIRST_ITERATIONS], most;
  if (first<usual) iw[MAX_ITERATIONS] = first;
  if (casadi_newton(arg, res, iw, w, arg[SHARES][NEWTON_SHARE]*allowed)
      >arg[SHARES][NEWTON_SHARE]*allowed) {
    allowed = tolerance*casadi_size(arg, iw, res[IMPULSE], scale);
    if (res[STATUS][RESIDUAL]>allowed && casadi_redundant(arg, res, iw)) {
      iw[MAX_ITERATIONS] = arg[SHARES][REDUNDANT_ITERATIONS];
      rounds = casadi_proximal(arg, res, iw, w, tolerance, scale, iw[MAX_PROXIMAL], 2);
      iw[MAX_ITERATIONS] = usual;
      return rounds;
    }
    if (first<usual) {
      iw[MAX_ITERATIONS] = usual - first;
      casadi_newton(arg, res, iw, w, arg[SHARES][NEWTON_SHARE]*allowed);
    }
  }
  iw[MAX_ITERATIONS] = usual;
  if (res[STATUS][RESIDUAL]<=tolerance*casadi_size(arg, iw, res[IMPULSE], scale)) return 0;
  most = 5*iw[FEW_PROXIMAL]<iw[MAX_PROXIMAL] ? 5*iw[FEW_PROXIMAL] : iw[MAX_PROXIMAL];
  rounds = casadi_proximal(arg, res, iw, w, tolerance, scale, most, 0);
  allowed = tolerance*casadi_size(arg, iw, res[IMPULSE], scale);
  if (res[STATUS][RESIDUAL]<=allowed) return rounds;
  casadi_centered(arg, res, iw, w, allowed, scale);
  iw[MAX_ITERATIONS] = arg[SHARES][LAST_ITERATIONS];
  rounds += casadi_proximal(arg, res, iw, w, tolerance, scale, iw[MAX_PROXIMAL], 1);
  iw[MAX_ITERATIONS] = usual;
  return rounds;
}
