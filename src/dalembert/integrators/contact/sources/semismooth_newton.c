/* Semismooth Newton method for frictional contact: linear system of a step, and its line search */
/* speeds of the contacts by their impulses, squared merit and residual */
static void casadi_state(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real* violation) {
  const casadi_real* directions = arg[DIRECTIONS];
  const casadi_real* velocity = arg[VELOCITY];
  const casadi_real* shift = arg[SHIFT];
  const int* w_row = (const int*) arg[DIRECTION_ROWS];
  const int* w_column = (const int*) arg[DIRECTION_COLUMNS];
  const casadi_real* impulse = res[IMPULSE];
  casadi_real* speed = res[VELOCITY];
  casadi_real* moved = res[SPEED_CHANGES];
  casadi_real* status = res[STATUS];
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], r;
  casadi_respond(arg[RESPONSES], (const int*) arg[RESPONSE_ROWS], (const int*) arg[RESPONSE_COLUMNS], impulse,
    rows, iw[SPEEDS], moved);
  for (r=0; r<rows; ++r) {
    speed[r] = velocity[r] + shift[r]*impulse[r];
    speed[r] += casadi_row(directions, w_column, w_row[r], w_row[r+1], moved);
  }
  status[MERIT] = casadi_merit(impulse, speed, arg[MOBILITY], arg[WEIGHTS], arg[FRICTION], arg[MINIMUM],
    (const int*) arg[GROUP_STARTS], iw[GROUPS], iw[CONTACTS], iw[COMPONENTS], violation, status + 1);
}
/* forget the pieces of the matrix, so that the next step assembles another */
static void casadi_forget(casadi_real* pieces, casadi_int count) {
  casadi_int i;
  for (i=0; i<count+2; ++i) pieces[i] = 0.5;
}
/* number of the piece of a contact: 0 without pressure, else by sticking or the direction of slip;
   negative if the derivatives vary within it */
static casadi_real casadi_piece(const casadi_real* z, const casadi_real* friction,
    casadi_real minimum, const int* group, casadi_int groups, casadi_int width) {
  casadi_int g, a, begin, end, varies = 0;
  casadi_real piece = z[0]>minimum ? 1.0 : 2.0, length, limit;
  if (!(z[0]>minimum || minimum>0)) return 0;
  for (g=0; g<groups; ++g) {
    begin = casadi_begin(group, groups, g);
    end = casadi_end(group, groups, width, g);
    length = 0;
    for (a=begin; a<end; ++a) length += z[a]*z[a];
    limit = friction[g]*(z[0]>minimum ? z[0] : minimum);
    piece = 3*piece;
    if (!(length>limit*limit) && friction[g]!=0) continue;
    piece += z[begin]>0 ? 2.0 : 1.0;
    if (end-begin>1) varies = 1;
  }
  return varies ? -piece : piece;
}
/* add the sum of W^T gain W of contacts with the bodies of a contact to the matrix; none if negative */
static void casadi_add_sum(casadi_real** res, const casadi_int* iw, casadi_int i, casadi_real* w) {
  casadi_int widest = iw[CONTACT_SPEEDS], size, b, c;
  casadi_real* sum = w + 2*iw[COMPONENTS]*widest;
  const int* place;
  if (i<0) return;
  size = ((const int*) res[COLUMN_STARTS])[i+1] - ((const int*) res[COLUMN_STARTS])[i];
  place = (const int*) res[ENTRIES] + ((const int*) res[ENTRY_STARTS])[i];
  for (b=0; b<size; ++b) {
    for (c=0; c<size; ++c) res[SYSTEM][place[b*size+c]] += sum[b*widest+c];
  }
}
/* add W^T gain W of a contact, with a gain by rows, to the sum of the contacts between the same bodies,
   of which last is the one before; other sums are added to the matrix. Returns the contact */
static casadi_int casadi_add_blocks(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_int i, const casadi_real* gain, casadi_real* w, casadi_int last) {
  const int* row = (const int*) arg[DIRECTION_ROWS];
  const int* local = (const int*) res[LOCAL_COLUMNS];
  const int* block = (const int*) res[ENTRY_STARTS];
  casadi_int width = iw[COMPONENTS], widest = iw[CONTACT_SPEEDS], a, b, c, j, r = i*width;
  casadi_int size = ((const int*) res[COLUMN_STARTS])[i+1] - ((const int*) res[COLUMN_STARTS])[i];
  casadi_real* sum = w + 2*width*widest;
  casadi_real near[72], far[72], factor[6], share;
  casadi_real* across = w;
  casadi_real* weighted = w + width*widest;
  if (width*widest<=72) {
    across = near;
    weighted = far;
  }
  if (last<0 || block[last]!=block[i]) {
    casadi_add_sum(res, iw, last, w);
    for (a=0; a<widest*widest; ++a) sum[a] = 0;
  }
  for (a=0; a<width*widest; ++a) across[a] = 0;
  for (a=0; a<width; ++a) {
    for (j=row[r+a]; j<row[r+a+1]; ++j) across[a*widest+local[j]] = arg[DIRECTIONS][j];
  }
  for (a=0; a<width; ++a) {
    for (b=0; b<width; ++b) factor[b] = gain[a*width+b];
    for (c=0; c<widest; ++c) {
      share = 0;
      for (b=0; b<width; ++b) share += factor[b]*across[b*widest+c];
      weighted[a*widest+c] = share;
    }
  }
  for (b=0; b<size; ++b) {
    for (a=0; a<width; ++a) factor[a] = weighted[a*widest+b];
    for (c=0; c<widest; ++c) {
      share = 0;
      for (a=0; a<width; ++a) share += across[a*widest+c]*factor[a];
      sum[b*widest+c] += share;
    }
  }
  return i;
}
/* add W^T free of a contact to the right-hand side */
static void casadi_add_push(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int i, const casadi_real* free) {
  const int* row = (const int*) arg[DIRECTION_ROWS];
  const int* column = (const int*) arg[DIRECTION_COLUMNS];
  casadi_int r, j;
  for (r=i*iw[COMPONENTS]; r<(i+1)*iw[COMPONENTS]; ++r) {
    for (j=row[r]; j<row[r+1]; ++j) res[RIGHT_SIDE][column[j]] += arg[DIRECTIONS][j]*free[r];
  }
}
/* residual and, above the tolerance, the equations of a step; 1 if a contact is singular. The
   matrix remains if the pieces are those of the step before, and their derivatives are the same or
   that step reduced the residual enough: pieces[count] is then 1. pieces[count+1] is its residual.
   The speeds are known after a step, unless this is the last one */
static int casadi_assemble(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real* w, casadi_real* pieces, casadi_int known) {
  const casadi_real* directions = arg[DIRECTIONS];
  const casadi_real* responses = arg[RESPONSES];
  const casadi_real* friction = arg[FRICTION];
  const casadi_real* minimum = arg[MINIMUM];
  const casadi_real* mobility = arg[MOBILITY];
  const casadi_real* shift = arg[SHIFT];
  const casadi_real* settings = arg[SETTINGS];
  const int* w_row = (const int*) arg[DIRECTION_ROWS];
  const int* w_column = (const int*) arg[DIRECTION_COLUMNS];
  const int* x_row = (const int*) arg[RESPONSE_ROWS];
  const int* x_column = (const int*) arg[RESPONSE_COLUMNS];
  const int* group = (const int*) arg[GROUP_STARTS];
  const casadi_real* impulse = res[IMPULSE];
  casadi_real* system = res[SYSTEM];
  casadi_real* push = res[RIGHT_SIDE];
  casadi_real* free = res[FREE_STEP];
  casadi_real* gain = res[GAIN];
  casadi_real* speed = res[VELOCITY];
  casadi_real* step = res[STEP];
  casadi_real* trial = res[TRIAL];
  casadi_real* moved = res[SPEED_CHANGES];
  casadi_real* status = res[STATUS];
  const casadi_real* constant = res[CONSTANT];
  casadi_int count = iw[CONTACTS], width = iw[COMPONENTS], groups = iw[GROUPS], speeds = iw[SPEEDS],
    entries = iw[ENTRIES];
  casadi_int unknowns = iw[UNKNOWNS], rows = count*width;
  casadi_real* own = w;
  casadi_real* coupled = own + width*width;
  casadi_real* z = coupled + width*width;
  casadi_real* both = z + width;
  casadi_real* violation = both + width*(width+1);
  casadi_real* across = violation + width;
  casadi_int i, a, b, j, r, varies = 0, last = -1;
  casadi_real share, u;
  if (!known || !(status[RESIDUAL]>settings[TOLERANCE])) casadi_state(arg, res, iw, violation);
  if (!(status[RESIDUAL]>settings[TOLERANCE])) return 0;
  pieces[count] = 1;
  for (i=0; i<count; ++i) {
    r = i*width;
    for (a=0; a<width; ++a) z[a] = impulse[r+a] - speed[r+a]/mobility[r+a];
    share = casadi_piece(z, friction + i*groups, minimum[i], group, groups, width);
    if (share!=pieces[i]) pieces[count] = 0;
    if (share<0) varies = 1;
    pieces[i] = share;
    casadi_violation(impulse + r, speed + r, mobility + r, friction + i*groups, minimum[i],
      group, groups, width, violation);
    status[DESCENDS] = share!=0 ? 1.0 : 0.0;
    for (a=0; a<width; ++a) {
      free[r+a] = -violation[a];
      step[r+a] = status[DESCENDS]>0 ? 0.0 : -violation[a];
      trial[r+a] = status[DESCENDS];
    }
  }
  casadi_respond(responses, x_row, x_column, step, rows, speeds, moved);
  if (varies && !(status[RESIDUAL]<=0.01*pieces[count+1])) pieces[count] = 0;
  pieces[count+1] = status[RESIDUAL];
  if (pieces[count]==0) {
    for (j=0; j<entries; ++j) system[j] = constant[j];
  }
  for (j=0; j<unknowns; ++j) push[j] = 0;
  for (i=0; i<count; ++i) {
    r = i*width;
    if (trial[r]==0) continue;
    for (a=0; a<width; ++a) z[a] = impulse[r+a] - speed[r+a]/mobility[r+a];
    casadi_pieces(z, mobility + r, friction + i*groups, minimum[i], group, groups, width, own,
      coupled);
    for (a=0; a<width; ++a) {
      u = casadi_row(directions, w_column, w_row[r+a], w_row[r+a+1], moved);
      z[a] = u;
    }
    for (a=0; a<width; ++a) {
      share = free[r+a];
      for (b=0; b<width; ++b) {
        share -= coupled[a*width+b]*z[b];
        both[a*(width+1)+b] = coupled[a*width+b];
        own[a*width+b] += coupled[a*width+b]*(settings[REGULARIZATION]*mobility[r+b] + shift[r+b]);
      }
      both[a*(width+1)+width] = share;
    }
    if (!casadi_eliminate_contact(own, both, group, groups, width, width + 1)) return 1;
    for (a=0; a<width; ++a) free[r+a] = both[a*(width+1)+width];
    casadi_add_push(arg, res, iw, i, free);
    if (pieces[count]==1) continue;
    for (a=0; a<width; ++a) {
      for (b=0; b<width; ++b) gain[(r+a)*width+b] = both[a*(width+1)+b];
    }
    last = casadi_add_blocks(arg, res, iw, i, gain + r*width, across, last);
  }
  casadi_add_sum(res, iw, last, across);
  return 0;
}
/* longest tried share of a step that reduces the merit; status[DESCENDS] is 0 without any */
static int casadi_search(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real* w) {
  const casadi_real* directions = arg[DIRECTIONS];
  const casadi_real* responses = arg[RESPONSES];
  const casadi_real* friction = arg[FRICTION];
  const casadi_real* minimum = arg[MINIMUM];
  const casadi_real* mobility = arg[MOBILITY];
  const casadi_real* weight = arg[WEIGHTS];
  const casadi_real* shift = arg[SHIFT];
  const casadi_real* settings = arg[SETTINGS];
  const int* w_row = (const int*) arg[DIRECTION_ROWS];
  const int* w_column = (const int*) arg[DIRECTION_COLUMNS];
  const int* x_row = (const int*) arg[RESPONSE_ROWS];
  const int* x_column = (const int*) arg[RESPONSE_COLUMNS];
  const int* group = (const int*) arg[GROUP_STARTS];
  const casadi_real* free = res[FREE_STEP];
  const casadi_real* gain = res[GAIN];
  casadi_real* speed = res[VELOCITY];
  const casadi_real* solution = res[SOLUTION];
  casadi_real* impulse = res[IMPULSE];
  casadi_real* step = res[STEP];
  casadi_real* change = res[CHANGE];
  casadi_real* trial = res[TRIAL];
  casadi_real* trial_speed = res[TRIAL_VELOCITY];
  casadi_real* moved = res[SPEED_CHANGES];
  casadi_real* status = res[STATUS];
  casadi_int count = iw[CONTACTS], width = iw[COMPONENTS], groups = iw[GROUPS], speeds = iw[SPEEDS],
    rows = count*width;
  casadi_real* z = w;
  casadi_real* violation = z + width;
  casadi_int i, a, b, c, r;
  casadi_real share, merit;
  for (i=0; i<count; ++i) {
    r = i*width;
    if (trial[r]==0) continue;
    for (a=0; a<width; ++a) {
      z[a] = casadi_row(directions, w_column, w_row[r+a], w_row[r+a+1], solution);
    }
    for (a=0; a<width; ++a) {
      share = free[r+a];
      for (b=0; b<width; ++b) share -= gain[(r+a)*width+b]*z[b];
      step[r+a] = share;
    }
  }
  casadi_respond(responses, x_row, x_column, step, rows, speeds, moved);
  for (r=0; r<rows; ++r) {
    change[r] = shift[r]*step[r];
    change[r] += casadi_row(directions, w_column, w_row[r], w_row[r+1], moved);
  }
  share = 1;
  for (c=0; c<5; ++c) {
    if (c==4) {
      share = casadi_first_change(impulse, speed, step, change, mobility, friction, minimum, group,
        groups, count, width, settings[OVERSHOOT]);
    }
    for (r=0; r<rows; ++r) {
      trial[r] = impulse[r] + share*step[r];
      trial_speed[r] = speed[r] + share*change[r];
    }
    merit = casadi_merit(trial, trial_speed, mobility, weight, friction, minimum, group, groups,
      count, width, violation, status + 1);
    if (merit<status[MERIT]) {
      for (r=0; r<rows; ++r) {
        impulse[r] = trial[r];
        speed[r] = trial_speed[r];
      }
      status[MERIT] = merit;
      status[DESCENDS] = 1;
      return 0;
    }
    share = 0.5*share;
  }
  status[DESCENDS] = 0;
  return 0;
}
/* steps with factors of blocks until the residual is within the tolerance; 1 if singular, 2 if it is
   within the tolerance in res[STATUS], with the velocities */
static int casadi_iterate(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real* w) {
  const casadi_real* settings = arg[SETTINGS];
  casadi_real* status = res[STATUS];
  const int* first = (const int*) arg[FACTOR_STARTS];
  const int* row = (const int*) arg[FACTOR_ROWS];
  const int* members = (const int*) arg[BLOCK_MEMBERS];
  casadi_int blocks = iw[BLOCKS], size = iw[BLOCK_SIZE], iterations = iw[MAX_ITERATIONS], k, j;
  casadi_int memory = iw[MERITS], rows = iw[CONTACTS]*iw[COMPONENTS], jumps = 0, known = 0;
  casadi_real* impulse = res[IMPULSE];
  casadi_real* best = w + iw[WORK];
  casadi_real* merits = best + rows;
  casadi_real* pieces = merits + memory;
  casadi_real* used = pieces + iw[CONTACTS] + 2;
  casadi_real least = 0, reference;
  pieces[iw[CONTACTS]+1] = 0;
  for (k=0; k<iterations; ++k) {
    if (casadi_assemble(arg, res, iw, w, pieces, known)) return 1;
    if (k==0 || status[MERIT]<least) {
      least = status[MERIT];
      for (j=0; j<rows; ++j) best[j] = impulse[j];
    }
    if (!(status[RESIDUAL]>settings[TOLERANCE])) return 2;
    merits[k%memory] = status[MERIT];
    reference = status[MERIT];
    for (j=0; j<memory && j<k; ++j) {
      if (merits[j]>reference) reference = merits[j];
    }
    status[MERIT] = reference;
    if (pieces[iw[CONTACTS]]==0 && casadi_factorise(res[SYSTEM], first, row, blocks, size, used, w)) {
      pieces[0] = 0.5;
      return 1;
    }
    casadi_solve(res[SYSTEM], first, row, members, blocks, size, used, res[RIGHT_SIDE], res[SOLUTION], w);
    for (j=0; j<iw[SPEEDS]; ++j) {
      if (!(fabs(res[SOLUTION][j])<1e300)) return 1;
    }
    if (casadi_search(arg, res, iw, w)) return 1;
    known = status[DESCENDS]>0;
    if (!known) {
      ++jumps;
      if (jumps>iw[MAX_JUMPS]) {
        for (j=0; j<rows; ++j) impulse[j] = best[j];
        return 0;
      }
      for (j=0; j<rows; ++j) impulse[j] += res[STEP][j];
    }
  }
  if (!(status[MERIT]<least)) {
    for (j=0; j<rows; ++j) impulse[j] = best[j];
  }
  return 0;
}
