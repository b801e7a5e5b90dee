/* One projected Gauss-Seidel sweep over contacts */
static void casadi_push(const casadi_real* value, const int* column, casadi_int begin,
    casadi_int end, casadi_real impulse, casadi_real* speed) {
  casadi_int j;
  for (j=begin; j<end; ++j) speed[column[j]] += value[j]*impulse;
}
/* impulses and speeds of the bodies after a sweep; the largest change as a speed */
static casadi_real casadi_sweep(const casadi_real** arg, casadi_real* impulse, casadi_real* speed,
    casadi_int count, casadi_int width, casadi_int groups, casadi_real* w) {
  const casadi_real* directions = arg[DIRECTIONS];
  const casadi_real* responses = arg[RESPONSES];
  const casadi_real* velocity = arg[VELOCITY];
  const casadi_real* friction = arg[FRICTION];
  const casadi_real* minimum = arg[MINIMUM];
  const casadi_real* mobility = arg[MOBILITY];
  const casadi_real* weight = arg[WEIGHTS];
  const casadi_real* shift = arg[SHIFT];
  const int* w_row = (const int*) arg[DIRECTION_ROWS];
  const int* w_column = (const int*) arg[DIRECTION_COLUMNS];
  const int* x_row = (const int*) arg[RESPONSE_ROWS];
  const int* x_column = (const int*) arg[RESPONSE_COLUMNS];
  const int* group = (const int*) arg[GROUP_STARTS];
  casadi_int i, g, a, r;
  casadi_real largest = 0, u, d, length, limit;
  for (i=0; i<count; ++i) {
    r = i*width;
    u = velocity[r] + shift[r]*impulse[r];
    u += casadi_row(directions, w_column, w_row[r], w_row[r+1], speed);
    d = impulse[r] - u/mobility[r];
    d = (d>minimum[i] ? d : minimum[i]) - impulse[r];
    if (d!=0) {
      impulse[r] += d;
      if (fabs(d)*weight[r]>largest) largest = fabs(d)*weight[r];
      casadi_push(responses, x_column, x_row[r], x_row[r+1], d, speed);
    }
    for (g=0; g<groups; ++g) {
      limit = friction[i*groups+g]*impulse[i*width];
      length = 0;
      for (a=group[g]; a<group[g+1]; ++a) {
        w[a] = 0;
        if (!(limit>0)) continue;
        r = i*width + a;
        u = velocity[r] + shift[r]*impulse[r];
        u += casadi_row(directions, w_column, w_row[r], w_row[r+1], speed);
        w[a] = impulse[r] - u/mobility[r];
        length += w[a]*w[a];
      }
      length = sqrt(length);
      for (a=group[g]; a<group[g+1]; ++a) {
        r = i*width + a;
        d = (length>limit ? w[a]*(limit/length) : w[a]) - impulse[r];
        if (d!=0) {
          impulse[r] += d;
          if (fabs(d)*weight[r]>largest) largest = fabs(d)*weight[r];
          casadi_push(responses, x_column, x_row[r], x_row[r+1], d, speed);
        }
      }
    }
  }
  return largest;
}
