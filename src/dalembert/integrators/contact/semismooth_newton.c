/* Semismooth Newton method for frictional contact: linear system of a step, and its line search */
/* speeds of the bodies by impulses of all contacts */
static void casadi_respond(const casadi_real* value, const int* row, const int* column,
    const casadi_real* impulse, casadi_int rows, casadi_int speeds, casadi_real* speed) {
  casadi_int r, j;
  for (j=0; j<speeds; ++j) speed[j] = 0;
  for (r=0; r<rows; ++r) {
    if (impulse[r]==0) continue;
    for (j=row[r]; j<row[r+1]; ++j) speed[column[j]] += value[j]*impulse[r];
  }
}
/* x = matrix \ x by elimination with row pivots; zero if the matrix is singular */
static int casadi_eliminate(casadi_real* matrix, casadi_real* x, casadi_int size,
    casadi_int columns) {
  casadi_int i, j, c, pivot;
  casadi_real largest, share;
  for (i=0; i<size; ++i) {
    pivot = i;
    largest = fabs(matrix[i*size+i]);
    for (j=i+1; j<size; ++j) {
      if (fabs(matrix[j*size+i])>largest) {
        largest = fabs(matrix[j*size+i]);
        pivot = j;
      }
    }
    if (!(largest>0)) return 0;
    if (pivot!=i) {
      for (c=0; c<size; ++c) {
        share = matrix[i*size+c];
        matrix[i*size+c] = matrix[pivot*size+c];
        matrix[pivot*size+c] = share;
      }
      for (c=0; c<columns; ++c) {
        share = x[i*columns+c];
        x[i*columns+c] = x[pivot*columns+c];
        x[pivot*columns+c] = share;
      }
    }
    for (j=0; j<size; ++j) {
      if (j==i) continue;
      share = matrix[j*size+i]/matrix[i*size+i];
      if (share==0) continue;
      for (c=i; c<size; ++c) matrix[j*size+c] -= share*matrix[i*size+c];
      for (c=0; c<columns; ++c) x[j*columns+c] -= share*x[i*columns+c];
    }
  }
  for (i=0; i<size; ++i) {
    for (c=0; c<columns; ++c) x[i*columns+c] = x[i*columns+c]/matrix[i*size+i];
  }
  return 1;
}
/* violation = impulse - projection of z = impulse - speed/mobility, of one contact */
static void casadi_violation(const casadi_real* impulse, const casadi_real* speed,
    const casadi_real* mobility, const casadi_real* friction, casadi_real minimum,
    const int* group, casadi_int groups, casadi_real* violation) {
  casadi_int g, a;
  casadi_real pressure, length, limit, share;
  pressure = impulse[0] - speed[0]/mobility[0];
  if (!(pressure>minimum)) pressure = minimum;
  violation[0] = impulse[0] - pressure;
  for (g=0; g<groups; ++g) {
    length = 0;
    for (a=group[g]; a<group[g+1]; ++a) {
      violation[a] = impulse[a] - speed[a]/mobility[a];
      length += violation[a]*violation[a];
    }
    length = sqrt(length);
    limit = friction[g]*pressure;
    share = length>limit ? limit/length : 1.0;
    for (a=group[g]; a<group[g+1]; ++a) violation[a] = impulse[a] - share*violation[a];
  }
}
/* squared merit of impulses, and their residual */
static casadi_real casadi_merit(const casadi_real* impulse, const casadi_real* speed,
    const casadi_real* mobility, const casadi_real* weight, const casadi_real* friction,
    const casadi_real* minimum, const int* group, casadi_int groups, casadi_int count,
    casadi_int width, casadi_real* violation, casadi_real* residual) {
  casadi_int i, a, r;
  casadi_real sum = 0;
  residual[0] = 0;
  for (i=0; i<count; ++i) {
    r = i*width;
    casadi_violation(impulse + r, speed + r, mobility + r, friction + i*groups, minimum[i], group,
      groups, violation);
    for (a=0; a<width; ++a) {
      sum += violation[a]*violation[a]*mobility[r+a];
      if (!(fabs(violation[a])*weight[r+a]<=residual[0])) {
        residual[0] = fabs(violation[a])*weight[r+a];
      }
    }
  }
  return sum;
}
/* derivatives of the violation by impulse (own) and by speed (coupled), of one contact */
static void casadi_pieces(const casadi_real* z, const casadi_real* mobility,
    const casadi_real* friction, casadi_real minimum, const int* group, casadi_int groups,
    casadi_int width, casadi_real* own, casadi_real* coupled) {
  casadi_int g, a, b;
  casadi_real pressure, pressed, length, limit, slip, direction;
  for (a=0; a<width*width; ++a) {
    own[a] = 0;
    coupled[a] = 0;
  }
  pressed = z[0]>minimum ? 1.0 : 0.0;
  pressure = z[0]>minimum ? z[0] : minimum;
  own[0] = 1 - pressed;
  coupled[0] = pressed/mobility[0];
  for (g=0; g<groups; ++g) {
    length = 0;
    for (a=group[g]; a<group[g+1]; ++a) length += z[a]*z[a];
    length = sqrt(length);
    limit = friction[g]*pressure;
    if (length>limit || friction[g]==0) {
      if (!(length>0)) length = 1;
      for (a=group[g]; a<group[g+1]; ++a) {
        direction = z[a]/length;
        for (b=group[g]; b<group[g+1]; ++b) {
          slip = (a==b ? 1.0 : 0.0) - direction*z[b]/length;
          slip = (a==b ? 1.0 : 0.0) - limit/length*slip;
          own[a*width+b] = slip;
          coupled[a*width+b] = ((a==b ? 1.0 : 0.0) - slip)/mobility[a];
        }
        own[a*width] = -pressed*friction[g]*direction;
        coupled[a*width] = pressed*friction[g]*direction/mobility[0];
      }
    } else {
      for (a=group[g]; a<group[g+1]; ++a) coupled[a*width+a] = 1/mobility[a];
    }
  }
}
/* the first positive root of a + b t + c t^2 beyond the limit, or the bound */
static casadi_real casadi_root(casadi_real a, casadi_real b, casadi_real c, casadi_real limit,
    casadi_real bound) {
  casadi_real square = b*b - 4*a*c, root, t;
  if (c==0) {
    if (b==0) return bound;
    t = -a/b;
    return (t>limit && t<bound) ? t : bound;
  }
  if (!(square>=0)) return bound;
  root = sqrt(square);
  t = (-b - root)/(2*c);
  if (t>limit && t<bound) bound = t;
  t = (-b + root)/(2*c);
  if (t>limit && t<bound) bound = t;
  return bound;
}
/* share of a step at which the first contact changes its piece */
static casadi_real casadi_first_change(const casadi_real* impulse, const casadi_real* speed,
    const casadi_real* step, const casadi_real* change, const casadi_real* mobility,
    const casadi_real* friction, const casadi_real* minimum, const int* group, casadi_int groups,
    casadi_int count, casadi_int width, casadi_real overshoot) {
  casadi_int i, g, a, r;
  casadi_real first = 1.0, z, dz, x, dx, radius, growth, square, limits[3];
  for (i=0; i<count; ++i) {
    r = i*width;
    z = impulse[r] - speed[r]/mobility[r];
    dz = step[r] - change[r]/mobility[r];
    first = casadi_root(z - minimum[i], dz, 0.0, overshoot, first);
    radius = z>minimum[i] ? z : minimum[i];
    growth = z>minimum[i] ? dz : 0.0;
    for (g=0; g<groups; ++g) {
      square = friction[i*groups+g]*friction[i*groups+g];
      limits[0] = -square*radius*radius;
      limits[1] = -2*square*radius*growth;
      limits[2] = -square*growth*growth;
      for (a=group[g]; a<group[g+1]; ++a) {
        x = impulse[r+a] - speed[r+a]/mobility[r+a];
        dx = step[r+a] - change[r+a]/mobility[r+a];
        limits[0] += x*x;
        limits[1] += 2*x*dx;
        limits[2] += dx*dx;
      }
      first = casadi_root(limits[0], limits[1], limits[2], overshoot, first);
    }
  }
  first = first*(1 + overshoot);
  return first<1 ? first : 1.0;
}
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w,
    int mem) {
  const casadi_real* directions = arg[0];
  const casadi_real* responses = arg[1];
  const casadi_real* velocity = arg[2];
  const casadi_real* friction = arg[3];
  const casadi_real* minimum = arg[4];
  const casadi_real* mobility = arg[5];
  const casadi_real* weight = arg[6];
  const casadi_real* shift = arg[7];
  const casadi_real* settings = arg[8];
  const casadi_real* inertia = arg[9];
  const casadi_real* solution = arg[10];
  const int* w_row = (const int*) arg[11];
  const int* w_column = (const int*) arg[12];
  const int* x_row = (const int*) arg[13];
  const int* x_column = (const int*) arg[14];
  const int* group = (const int*) arg[15];
  const int* start = (const int*) arg[16];
  const int* column = (const int*) arg[17];
  const int* local = (const int*) arg[18];
  const int* block = (const int*) arg[19];
  const int* place = (const int*) arg[20];
  casadi_real* impulse = res[0];
  casadi_real* system = res[1];
  casadi_real* push = res[2];
  casadi_real* free = res[3];
  casadi_real* gain = res[4];
  casadi_real* speed = res[5];
  casadi_real* step = res[6];
  casadi_real* change = res[7];
  casadi_real* trial = res[8];
  casadi_real* trial_speed = res[9];
  casadi_real* moved = res[10];
  casadi_real* status = res[11];
  casadi_int count = iw[0], width = iw[1], groups = iw[2], speeds = iw[3], entries = iw[4];
  casadi_int unknowns = iw[5], searching = iw[6], widest = iw[7], rows = count*width;
  casadi_real* own = w;
  casadi_real* coupled = own + width*width;
  casadi_real* z = coupled + width*width;
  casadi_real* both = z + width;
  casadi_real* violation = both + width*(width+1);
  casadi_real* across = violation + width;
  casadi_real* weighted = across + width*widest;
  casadi_int i, a, b, c, j, r, size, first;
  casadi_real share, merit, u;
  if (!searching) {
    casadi_respond(responses, x_row, x_column, impulse, rows, speeds, moved);
    for (r=0; r<rows; ++r) {
      speed[r] = velocity[r] + shift[r]*impulse[r];
      speed[r] += casadi_row(directions, w_column, w_row[r], w_row[r+1], moved);
    }
    status[0] = casadi_merit(impulse, speed, mobility, weight, friction, minimum, group, groups,
      count, width, violation, status + 1);
    if (!(status[1]>settings[0])) return 0;
    for (i=0; i<count; ++i) {
      r = i*width;
      casadi_violation(impulse + r, speed + r, mobility + r, friction + i*groups, minimum[i],
        group, groups, violation);
      share = impulse[r] - speed[r]/mobility[r];
      status[2] = (share>minimum[i] || minimum[i]>0) ? 1.0 : 0.0;
      for (a=0; a<width; ++a) {
        free[r+a] = -violation[a];
        step[r+a] = status[2]>0 ? 0.0 : -violation[a];
        trial[r+a] = status[2];
      }
    }
    casadi_respond(responses, x_row, x_column, step, rows, speeds, moved);
    for (j=0; j<entries; ++j) system[j] = inertia[j];
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
          own[a*width+b] += coupled[a*width+b]*(settings[1]*mobility[r+b] + shift[r+b]);
        }
        both[a*(width+1)+width] = share;
      }
      if (!casadi_eliminate(own, both, width, width + 1)) return 1;
      size = start[i+1] - start[i];
      for (a=0; a<width*size; ++a) across[a] = 0;
      for (a=0; a<width; ++a) {
        free[r+a] = both[a*(width+1)+width];
        for (b=0; b<width; ++b) gain[(r+a)*width+b] = both[a*(width+1)+b];
        for (j=w_row[r+a]; j<w_row[r+a+1]; ++j) across[a*size+local[j]] = directions[j];
      }
      for (a=0; a<width; ++a) {
        for (c=0; c<size; ++c) {
          share = 0;
          for (b=0; b<width; ++b) share += both[a*(width+1)+b]*across[b*size+c];
          weighted[a*size+c] = share;
        }
      }
      first = block[i];
      for (b=0; b<size; ++b) {
        for (c=0; c<size; ++c) {
          share = 0;
          for (a=0; a<width; ++a) share += across[a*size+c]*weighted[a*size+b];
          system[place[first+b*size+c]] += share;
        }
        share = 0;
        for (a=0; a<width; ++a) share += across[a*size+b]*free[r+a];
        push[column[start[i]+b]] += share;
      }
    }
    return 0;
  }
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
        groups, count, width, settings[2]);
    }
    for (r=0; r<rows; ++r) {
      trial[r] = impulse[r] + share*step[r];
      trial_speed[r] = speed[r] + share*change[r];
    }
    merit = casadi_merit(trial, trial_speed, mobility, weight, friction, minimum, group, groups,
      count, width, violation, status + 1);
    if (merit<status[0]) {
      for (r=0; r<rows; ++r) impulse[r] = trial[r];
      status[0] = merit;
      status[2] = 1;
      return 0;
    }
    share = 0.5*share;
  }
  status[2] = 0;
  return 0;
}
