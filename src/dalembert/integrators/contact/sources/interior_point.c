/* Interior point method for Coulomb friction: x = (mu P_N, P_T) and s = (u_N/mu + |u_T|, u_T) are in
   second-order cones with x.s = 0 (De Saxce & Feng 1998; Acary, Armand, Nguyen & Shpakovych 2024),
   with predictor and corrector (Mehrotra 1992) in the scaling of Nesterov & Todd (1997) */
/* magnitude of the components beyond the first */
static casadi_real casadi_length(const casadi_real* x, casadi_int size) {
  casadi_int a;
  casadi_real square = 0;
  for (a=1; a<size; ++a) square += x[a]*x[a];
  return sqrt(square);
}
/* x_0^2 - |x_T|^2 */
static casadi_real casadi_determinant(const casadi_real* x, casadi_int size) {
  casadi_real length = casadi_length(x, size);
  return (x[0] - length)*(x[0] + length);
}
/* dimension of the cone of a contact, one without friction; the other components are zero */
static casadi_int casadi_cone(const casadi_real** arg, const casadi_int* iw, casadi_int i) {
  return iw[GROUPS]>0 && arg[FRICTION][i]>0 ? iw[COMPONENTS] : 1;
}
/* ratio of x_0 to the normal impulse */
static casadi_real casadi_slope(const casadi_real** arg, const casadi_int* iw, casadi_int i) {
  return casadi_cone(arg, iw, i)>1 ? arg[FRICTION][i] : 1.0;
}
/* s of the speeds of a contact */
static void casadi_slack(const casadi_real* speed, casadi_real slope, casadi_int size,
    casadi_real* slack) {
  casadi_int a;
  for (a=1; a<size; ++a) slack[a] = speed[a];
  slack[0] = speed[0]/slope + casadi_length(speed, size);
}
/* y = scale (2 w w^T - J) x, or with J w and the inverse of the scale */
static void casadi_turn(const casadi_real* w, casadi_real scale, casadi_int inverse,
    const casadi_real* x, casadi_int size, casadi_real* y) {
  casadi_int a;
  casadi_real share = w[0]*x[0];
  for (a=1; a<size; ++a) share += inverse ? -w[a]*x[a] : w[a]*x[a];
  if (inverse) scale = 1/scale;
  for (a=1; a<size; ++a) y[a] = scale*(x[a] + 2*share*(inverse ? -w[a] : w[a]));
  y[0] = scale*(2*share*w[0] - x[0]);
}
/* scaling of a contact: root of the scaling point's rotation, axis of its square, and scale */
static casadi_real casadi_scaling(const casadi_real* x, const casadi_real* s, casadi_int size,
    casadi_real* root, casadi_real* axis) {
  casadi_real first = casadi_determinant(x, size), second = casadi_determinant(s, size);
  casadi_real product = 0, one = sqrt(first), other = sqrt(second), share;
  casadi_int a;
  for (a=0; a<size; ++a) product += (x[a]/one)*(s[a]/other);
  share = 2*sqrt((1 + product)/2);
  for (a=0; a<size; ++a) axis[a] = (s[a]/other + (a>0 ? -x[a] : x[a])/one)/share;
  share = sqrt(2*(axis[0] + 1));
  for (a=0; a<size; ++a) root[a] = (axis[a] + (a==0 ? 1.0 : 0.0))/share;
  return sqrt(other/one);
}
/* the largest share of a step that stays in the cone, or the bound */
static casadi_real casadi_boundary(const casadi_real* x, const casadi_real* dx, casadi_int size,
    casadi_real bound) {
  casadi_real a = dx[0]*dx[0], b = 2*x[0]*dx[0];
  casadi_int k;
  for (k=1; k<size; ++k) {
    a -= dx[k]*dx[k];
    b -= 2*x[k]*dx[k];
  }
  if (dx[0]<0 && -x[0]/dx[0]<bound) bound = -x[0]/dx[0];
  return size>1 ? casadi_root(casadi_determinant(x, size), b, a, 0.0, bound) : bound;
}
/* q with scaled o q = r (Jordan product) */
static void casadi_divide(const casadi_real* scaled, const casadi_real* r, casadi_int size,
    casadi_real* q) {
  casadi_int a;
  casadi_real sum = scaled[0]*r[0];
  for (a=1; a<size; ++a) sum -= scaled[a]*r[a];
  sum = size>1 ? sum/casadi_determinant(scaled, size) : r[0]/scaled[0];
  for (a=1; a<size; ++a) q[a] = (r[a] - sum*scaled[a])/scaled[0];
  q[0] = sum;
}
/* minus the products of the scaled variables, and of their changes by the predictor; plus a centre
 */
static void casadi_target(const casadi_real* scaled, const casadi_real* dx, const casadi_real* ds,
    casadi_real center, casadi_int size, casadi_real* r) {
  casadi_int a;
  r[0] = center;
  for (a=0; a<size; ++a) r[0] -= scaled[a]*scaled[a] + dx[a]*ds[a];
  for (a=1; a<size; ++a) {
    r[a] = -2*scaled[0]*scaled[a] - dx[0]*ds[a] - ds[0]*dx[a];
  }
}
/* impulses of a contact by its speeds, inverse gain with inverse = (1 + gain shift)^-1 and gain =
   W^-2 ds/du in impulses; 1 if singular */
static int casadi_linearise(const casadi_real** arg, const casadi_int* iw, casadi_int i,
    const casadi_real* axis, casadi_real scale, const casadi_real* speed, casadi_real shift,
    casadi_real* gain, casadi_real* inverse, casadi_real* w) {
  casadi_int width = iw[COMPONENTS], size = casadi_cone(arg, iw, i), a, b, k;
  casadi_real slope = casadi_slope(arg, iw, i), length = casadi_length(speed, width), sum;
  casadi_real* left = w;
  casadi_real* own = left + width*width;
  casadi_real* column = own + width*width;
  casadi_real* turned = column + width;
  for (b=0; b<width; ++b) {
    for (a=0; a<width; ++a) column[a] = a==b ? 1.0 : 0.0;
    column[0] = b==0 ? 1/slope : (length>0 ? speed[b]/length : 0.0);
    casadi_turn(axis, scale*scale, 1, column, width, turned);
    for (a=0; a<width; ++a) {
      own[a*width+b] = (a<size && b<size) ? turned[a] : 0.0;
      if (a==0) own[b] = own[b]/slope;
      inverse[a*width+b] = a==b ? 1.0 : 0.0;
      left[a*width+b] = inverse[a*width+b] + own[a*width+b]*shift*arg[MOBILITY][i*width+b];
    }
  }
  if (!casadi_eliminate(left, inverse, width, width)) return 1;
  for (a=0; a<width; ++a) {
    for (b=0; b<width; ++b) {
      sum = 0;
      for (k=0; k<width; ++k) sum += inverse[a*width+k]*own[k*width+b];
      gain[a*width+b] = sum;
    }
  }
  return 0;
}
/* x and s in the interior of the cones, near the impulses in res[IMPULSE] */
static void casadi_interior_start(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real largest, casadi_real share, casadi_real* w) {
  casadi_real* x = res[PRIMAL];
  casadi_real* s = res[SLACK];
  casadi_int width = iw[COMPONENTS], i, a, r, size;
  casadi_real slope, length;
  casadi_shorten(arg, res[IMPULSE], iw);
  casadi_state(arg, res, iw, w);
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    size = casadi_cone(arg, iw, i);
    slope = casadi_slope(arg, iw, i);
    for (a=0; a<width; ++a) x[r+a] = a<size ? res[IMPULSE][r+a] : 0.0;
    x[r] = slope*x[r] + share*largest/arg[MOBILITY][r];
    casadi_slack(res[VELOCITY] + r, slope, size, s + r);
    for (a=size; a<width; ++a) s[r+a] = 0;
    length = casadi_length(s + r, width);
    s[r] = (s[r]>length ? s[r] : length) + 2*share*largest;
  }
}
/* impulses of x, their speeds and residual */
static void casadi_interior_impulses(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real* w) {
  casadi_int i, a;
  for (i=0; i<iw[CONTACTS]; ++i) {
    for (a=0; a<iw[COMPONENTS]; ++a) res[IMPULSE][i*iw[COMPONENTS]+a] = res[PRIMAL][i*iw[COMPONENTS]+a];
    res[IMPULSE][i*iw[COMPONENTS]] = res[IMPULSE][i*iw[COMPONENTS]]/casadi_slope(arg, iw, i);
  }
  casadi_state(arg, res, iw, w);
}
/* scaled variables, and the residuals of s in res[CHANGE]; the mean of x.s */
static casadi_real casadi_interior_state(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw) {
  const casadi_real* x = res[PRIMAL];
  const casadi_real* s = res[SLACK];
  casadi_int width = iw[COMPONENTS], i, a, r, size;
  casadi_real gap = 0;
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    size = casadi_cone(arg, iw, i);
    res[SCALING][i] = casadi_scaling(x + r, s + r, width, res[SCALING_ROOT] + r, res[SCALING_AXIS] + r);
    casadi_turn(res[SCALING_ROOT] + r, res[SCALING][i], 0, x + r, width, res[SCALED] + r);
    casadi_slack(res[VELOCITY] + r, casadi_slope(arg, iw, i), size, res[CHANGE] + r);
    for (a=0; a<width; ++a) {
      gap += x[r+a]*s[r+a];
      res[CHANGE][r+a] = a<size ? res[CHANGE][r+a] - s[r+a] : 0.0;
      res[PRIMAL_STEP][r+a] = 0;
      res[SLACK_STEP][r+a] = 0;
    }
  }
  return gap/iw[CONTACTS];
}
/* matrix of the steps; 1 if a contact is singular */
static int casadi_interior_matrix(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real shift, casadi_real* w) {
  casadi_int width = iw[COMPONENTS], square = iw[COMPONENTS]*iw[COMPONENTS], last = -1, i, j;
  casadi_real* sums = w + 4*square;
  for (j=0; j<iw[ENTRIES]; ++j) res[SYSTEM][j] = res[CONSTANT][j];
  for (i=0; i<iw[CONTACTS]; ++i) {
    if (casadi_linearise(arg, iw, i, res[SCALING_AXIS] + i*width, res[SCALING][i], res[VELOCITY] + i*width,
        shift, res[GAIN] + i*square, res[CONTACT_INVERSE] + i*square, w)) return 1;
    last = casadi_add_blocks(arg, res, iw, i, res[GAIN] + i*square, sums, last);
  }
  casadi_add_sum(res, iw, last, sums);
  return 0;
}
/* equations of a step to a centre, after the predictor in res[PRIMAL_STEP] and res[SLACK_STEP] */
static void casadi_interior_equations(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real center, casadi_real* w) {
  casadi_int width = iw[COMPONENTS], i, a, b, r, size;
  casadi_real* q = w;
  casadi_real* right = q + 3*width;
  casadi_real scale;
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    size = casadi_cone(arg, iw, i);
    scale = res[SCALING][i];
    casadi_turn(res[SCALING_ROOT] + r, scale, 0, res[PRIMAL_STEP] + r, width, q);
    casadi_turn(res[SCALING_ROOT] + r, scale, 1, res[SLACK_STEP] + r, width, q + width);
    casadi_target(res[SCALED] + r, q, q + width, center, width, q + 2*width);
    casadi_divide(res[SCALED] + r, q + 2*width, width, q);
    casadi_turn(res[SCALING_ROOT] + r, scale, 1, q, width, q + width);
    casadi_turn(res[SCALING_AXIS] + r, scale*scale, 1, res[CHANGE] + r, width, q);
    for (a=0; a<width; ++a) right[a] = a<size ? q[width+a] - q[a] : 0.0;
    right[0] = right[0]/casadi_slope(arg, iw, i);
    for (a=0; a<width; ++a) {
      res[FREE_STEP][r+a] = 0;
      for (b=0; b<width; ++b) res[FREE_STEP][r+a] += res[CONTACT_INVERSE][(r+a)*width+b]*right[b];
    }
  }
}
/* changes of x and s by the equations; the largest share of these within the cones */
static casadi_real casadi_interior_step(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real shift, const casadi_real* used, casadi_real* w) {
  const int* row = (const int*) arg[DIRECTION_ROWS];
  const casadi_real* speed = res[VELOCITY];
  casadi_real* dx = res[PRIMAL_STEP];
  casadi_real* ds = res[SLACK_STEP];
  casadi_int width = iw[COMPONENTS], i, a, b, r, j, size;
  casadi_real slope, length, share = 1;
  casadi_real* z = w;
  for (j=0; j<iw[UNKNOWNS]; ++j) res[RIGHT_SIDE][j] = 0;
  for (i=0; i<iw[CONTACTS]; ++i) casadi_add_push(arg, res, iw, i, res[FREE_STEP]);
  casadi_solve(res[SYSTEM], (const int*) arg[FACTOR_STARTS], (const int*) arg[FACTOR_ROWS],
    (const int*) arg[BLOCK_MEMBERS], iw[BLOCKS], iw[BLOCK_SIZE], used, res[RIGHT_SIDE], res[SOLUTION], w);
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    size = casadi_cone(arg, iw, i);
    slope = casadi_slope(arg, iw, i);
    for (a=0; a<width; ++a) {
      z[a] = casadi_row(arg[DIRECTIONS], (const int*) arg[DIRECTION_COLUMNS], row[r+a], row[r+a+1],
        res[SOLUTION]);
    }
    for (a=0; a<size; ++a) {
      dx[r+a] = res[FREE_STEP][r+a];
      for (b=0; b<width; ++b) dx[r+a] -= res[GAIN][(r+a)*width+b]*z[b];
    }
    for (a=0; a<size; ++a) z[a] += shift*arg[MOBILITY][r+a]*dx[r+a];
    dx[r] = slope*dx[r];
    length = casadi_length(speed + r, width);
    ds[r] = res[CHANGE][r] + z[0]/slope;
    for (a=1; a<size; ++a) {
      if (length>0) ds[r] += speed[r+a]/length*z[a];
      ds[r+a] = z[a] + res[CHANGE][r+a];
    }
    share = casadi_boundary(res[PRIMAL] + r, dx + r, width, share);
    share = casadi_boundary(res[SLACK] + r, ds + r, width, share);
  }
  return share;
}
/* x and s after a share of their changes, in the cones in spite of rounding */
static void casadi_interior_move(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real share, casadi_real largest) {
  casadi_real* x = res[PRIMAL];
  casadi_real* s = res[SLACK];
  casadi_int width = iw[COMPONENTS], i, a, r;
  casadi_real length;
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    for (a=0; a<width; ++a) {
      x[r+a] += share*res[PRIMAL_STEP][r+a];
      s[r+a] += share*res[SLACK_STEP][r+a];
    }
    length = casadi_length(x + r, width)*(1 + 1e-13);
    if (!(x[r]>length)) x[r] = length + 1e-14*largest/arg[MOBILITY][r];
    length = casadi_length(s + r, width)*(1 + 1e-13);
    if (!(s[r]>length)) s[r] = length + 1e-14*largest;
  }
}
/* share of the gap that remains after a share of the predictor, cubed */
static casadi_real casadi_interior_center(casadi_real** res, casadi_int rows, casadi_real share,
    casadi_real sum) {
  casadi_int r;
  casadi_real next = 0;
  for (r=0; r<rows; ++r) {
    next += (res[PRIMAL][r] + share*res[PRIMAL_STEP][r])*(res[SLACK][r] + share*res[SLACK_STEP][r]);
  }
  next = next>0 ? (next<sum ? next/sum : 1.0) : 0.0;
  return next*next*next;
}
/* one iteration from the speeds in res[VELOCITY]; the share of the step, negative if singular */
static casadi_real casadi_interior(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real* w, casadi_real largest) {
  casadi_real shift = arg[SHARES][res[STATUS][RESIDUAL]<arg[SHARES][INTERIOR_END]*largest
    ? LAST_REGULARIZATION : REGULARIZATION];
  casadi_real* used = w + iw[WORK] + iw[CONTACTS]*iw[COMPONENTS] + iw[MERITS] + iw[CONTACTS] + 2;
  casadi_real gap = casadi_interior_state(arg, res, iw), share, center;
  if (casadi_interior_matrix(arg, res, iw, shift, w)) return -1;
  if (casadi_factorise(res[SYSTEM], (const int*) arg[FACTOR_STARTS], (const int*) arg[FACTOR_ROWS],
      iw[BLOCKS], iw[BLOCK_SIZE], used, w)) return -1;
  casadi_interior_equations(arg, res, iw, 0.0, w);
  share = casadi_interior_step(arg, res, iw, shift, used, w);
  center = casadi_interior_center(res, iw[CONTACTS]*iw[COMPONENTS], share, gap*iw[CONTACTS]);
  casadi_interior_equations(arg, res, iw, center*gap, w);
  share = arg[SHARES][TO_BOUNDARY]*casadi_interior_step(arg, res, iw, shift, used, w);
  casadi_interior_move(arg, res, iw, share, largest);
  return share;
}
