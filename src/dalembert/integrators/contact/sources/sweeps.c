/* Projected Gauss-Seidel sweeps over contacts with Anderson acceleration */
static casadi_real casadi_product(const casadi_real* x, const casadi_real* y, casadi_int size) {
  casadi_int i;
  casadi_real a = 0, b = 0, c = 0, d = 0;
  for (i=0; i+3<size; i+=4) {
    a += x[i]*y[i];
    b += x[i+1]*y[i+1];
    c += x[i+2]*y[i+2];
    d += x[i+3]*y[i+3];
  }
  for (; i<size; ++i) a += x[i]*y[i];
  return a + b + c + d;
}
/* y -= share*x */
static void casadi_reduce(casadi_real* y, const casadi_real* x, casadi_real share,
    casadi_int size) {
  casadi_int i;
  for (i=0; i<size; ++i) y[i] -= share*x[i];
}
/* y = x - y, the change since the last sweep */
static void casadi_change(const casadi_real* x, casadi_real* y, casadi_int size) {
  casadi_int i;
  for (i=0; i<size; ++i) y[i] = x[i] - y[i];
}
static void casadi_copy_to(const casadi_real* x, casadi_real* y, casadi_int size) {
  casadi_int i;
  for (i=0; i<size; ++i) y[i] = x[i];
}
/* Cholesky solution of the scaled normal equations; share holds the right-hand side */
static void casadi_shares(const casadi_real* gram, casadi_int size, casadi_int stride,
    casadi_real regularization, casadi_real* factor, casadi_real* share) {
  casadi_int i, j, k;
  casadi_real sum;
  for (i=0; i<size; ++i) {
    for (j=0; j<=i; ++j) {
      sum = gram[i*stride+j];
      if (i==j) sum += sum*regularization;
      for (k=0; k<j; ++k) sum -= factor[i*stride+k]*factor[j*stride+k];
      if (i==j) factor[i*stride+i] = sum>0 ? sqrt(sum) : 0.0;
      else factor[i*stride+j] = factor[j*stride+j]>0 ? sum/factor[j*stride+j] : 0.0;
    }
  }
  for (i=0; i<size; ++i) {
    for (k=0; k<i; ++k) share[i] -= factor[i*stride+k]*share[k];
    share[i] = factor[i*stride+i]>0 ? share[i]/factor[i*stride+i] : 0.0;
  }
  for (i=size-1; i>=0; --i) {
    for (k=i+1; k<size; ++k) share[i] -= factor[k*stride+i]*share[k];
    share[i] = factor[i*stride+i]>0 ? share[i]/factor[i*stride+i] : 0.0;
  }
}
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w,
    int mem) {
  const casadi_real* mobility = arg[MOBILITY];
  const casadi_real* settings = arg[SETTINGS];
  casadi_real* impulse = res[IMPULSE];
  casadi_real* speed = res[SPEEDS];
  casadi_int count = iw[CONTACTS], width = iw[COMPONENTS], groups = iw[GROUPS], sweeps = iw[MAX_SWEEPS],
    speeds = iw[SPEEDS];
  casadi_int depth = iw[DEPTH], rows = count*width;
  casadi_real* change = w + width;
  casadi_real* old_change = change + rows;
  casadi_real* old_impulse = old_change + rows;
  casadi_real* old_speed = old_impulse + rows;
  casadi_real* share = old_speed + speeds;
  casadi_real* gram = share + depth;
  casadi_real* factor = gram + depth*depth;
  casadi_real* changes = factor + depth*depth;
  casadi_real* impulses = changes + depth*rows;
  casadi_real* velocities = impulses + depth*rows;
  casadi_int sweep, i, r, slot = 0, stored = 0;
  casadi_real largest, d, square, last = 0;
  for (sweep=0; sweep<sweeps; ++sweep) {
    casadi_copy_to(impulse, change, rows);
    largest = casadi_sweep(arg, impulse, speed, count, width, groups, w);
    if (!(largest>settings[TOLERANCE])) return 0;
    square = 0;
    for (r=0; r<rows; ++r) {
      change[r] = (impulse[r] - change[r])*sqrt(mobility[r]);
      square += change[r]*change[r];
    }
    if (sweep==0 || square>settings[GROWTH]*last) {
      stored = 0;
      slot = 0;
    } else {
      casadi_change(change, old_change, rows);
      casadi_change(impulse, old_impulse, rows);
      casadi_change(speed, old_speed, speeds);
      casadi_copy_to(old_change, changes + slot*rows, rows);
      casadi_copy_to(old_impulse, impulses + slot*rows, rows);
      casadi_copy_to(old_speed, velocities + slot*speeds, speeds);
      if (stored<depth) ++stored;
      for (i=0; i<stored; ++i) {
        d = casadi_product(changes + slot*rows, changes + i*rows, rows);
        gram[slot*depth+i] = d;
        gram[i*depth+slot] = d;
        share[i] = casadi_product(changes + i*rows, change, rows);
      }
      slot = slot+1<depth ? slot+1 : 0;
      casadi_shares(gram, stored, depth, settings[REGULARIZATION], factor, share);
    }
    last = square;
    casadi_copy_to(change, old_change, rows);
    casadi_copy_to(impulse, old_impulse, rows);
    casadi_copy_to(speed, old_speed, speeds);
    if (sweep+1==sweeps) return 0;
    for (i=0; i<stored; ++i) {
      casadi_reduce(impulse, impulses + i*rows, share[i], rows);
      casadi_reduce(speed, velocities + i*speeds, share[i], speeds);
    }
  }
  return 0;
}
