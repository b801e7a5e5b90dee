/* Directions of contacts, and accelerations of free bodies */
/* directions of a contact: the normal, then one tangent in the plane or two in space */
static void casadi_tangents(casadi_real* direction, casadi_int dimension) {
  casadi_real sign, a;
  const casadi_real* z = direction;
  if (dimension==2) {
    direction[3] = z[1];
    direction[4] = -z[0];
    direction[5] = 0;
    direction[6] = 0;
    direction[7] = 0;
    direction[8] = 1;
    return;
  }
  sign = z[2]<0 ? -1.0 : 1.0;
  a = -1/(sign + z[2]);
  direction[3] = 1 + sign*z[0]*z[0]*a;
  direction[4] = sign*(z[0]*z[1]*a);
  direction[5] = -sign*z[0];
  direction[6] = z[0]*z[1]*a;
  direction[7] = sign + z[1]*z[1]*a;
  direction[8] = -z[1];
}
/* row of W for one shape: velocity along a direction at a place with an arm, or, without an arm,
   angular velocity about the direction */
static void casadi_lever(const casadi_real* shape, casadi_int width, casadi_int size,
    const casadi_real* direction, const casadi_real* arm, casadi_int turns, casadi_real sign,
    casadi_real* row) {
  casadi_int c;
  casadi_real f[6];
  f[0] = turns ? 0.0 : sign*direction[0];
  f[1] = turns ? 0.0 : sign*direction[1];
  f[2] = turns ? 0.0 : sign*direction[2];
  f[3] = sign*(turns ? direction[0] : arm[1]*direction[2] - arm[2]*direction[1]);
  f[4] = sign*(turns ? direction[1] : arm[2]*direction[0] - arm[0]*direction[2]);
  f[5] = sign*(turns ? direction[2] : arm[0]*direction[1] - arm[1]*direction[0]);
  for (c=0; c<size; ++c) {
    row[c] = f[0]*shape[c] + f[1]*shape[width+c] + f[2]*shape[2*width+c]
      + f[3]*shape[3*width+c] + f[4]*shape[4*width+c] + f[5]*shape[5*width+c];
  }
}
/* inverses of the blocks of the inertia, unless it is the one of the step before; 1 if singular */
static int casadi_invert(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real* w) {
  const casadi_real* inertia = arg[INERTIA];
  const int* a_row = (const int*) arg[INERTIA_ROWS];
  const int* a_column = (const int*) arg[INERTIA_COLUMNS];
  const int* start = (const int*) arg[BODY_STARTS];
  casadi_real* inverse = res[INVERSES];
  casadi_real* last = res[LAST_INERTIA];
  casadi_int bodies = iw[BODIES], widest = iw[BLOCK_SIZE], entries = iw[INERTIA_ENTRIES], b, k, j, size,
    changed = 0;
  for (k=0; k<entries; ++k) {
    if (inertia[k]!=last[k]) changed = 1;
    last[k] = inertia[k];
  }
  if (!changed) return 0;
  for (b=0; b<bodies; ++b) {
    size = start[b+1] - start[b];
    for (k=0; k<size*size; ++k) {
      w[k] = 0;
      inverse[b*widest*widest+k] = 0;
    }
    for (k=0; k<size; ++k) {
      inverse[b*widest*widest+k*size+k] = 1;
      for (j=a_row[start[b]+k]; j<a_row[start[b]+k+1]; ++j) {
        w[k*size+a_column[j]-start[b]] = inertia[j];
      }
    }
    if (!casadi_eliminate(w, inverse + b*widest*widest, size, size)) {
      last[0] = inertia[0] + 1;
      return 1;
    }
  }
  return 0;
}
/* x = x + A \ (factor right) */
static void casadi_accelerate(const casadi_real* inverse, const int* start, casadi_int bodies,
    casadi_int widest, casadi_real factor, const casadi_real* right, casadi_real* x) {
  casadi_int b, j, k, size;
  casadi_real sum;
  for (b=0; b<bodies; ++b) {
    size = start[b+1] - start[b];
    for (k=0; k<size; ++k) {
      sum = 0;
      for (j=0; j<size; ++j) sum += inverse[b*widest*widest+k*size+j]*right[start[b]+j];
      x[start[b]+k] += factor*sum;
    }
  }
}
