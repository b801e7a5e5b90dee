/* Pieces of the conditions of frictional contact, and their changes along a step */
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
/* target = target - share line, of a number of entries */
static void casadi_reduce(casadi_real* target, const casadi_real* line, casadi_real share,
    casadi_int count) {
  casadi_int c;
  casadi_real sums[6];
  if (count==6) {
    for (c=0; c<6; ++c) sums[c] = target[c] - share*line[c];
    for (c=0; c<6; ++c) target[c] = sums[c];
    return;
  }
  for (c=0; c<count; ++c) target[c] -= share*line[c];
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
    share = 1/matrix[i*size+i];
    for (c=i+1; c<size; ++c) matrix[i*size+c] = matrix[i*size+c]*share;
    for (c=0; c<columns; ++c) x[i*columns+c] = x[i*columns+c]*share;
    for (j=0; j<size; ++j) {
      share = matrix[j*size+i];
      if (j==i || share==0) continue;
      casadi_reduce(matrix + j*size, matrix + i*size, share, size);
      casadi_reduce(x + j*columns, x + i*columns, share, columns);
    }
  }
  return 1;
}
/* the first component of a group of tangents, and the one after its last; of one group, constants */
static casadi_int casadi_begin(const int* group, casadi_int groups, casadi_int g) {
  return groups==1 ? 1 : group[g];
}
static casadi_int casadi_end(const int* group, casadi_int groups, casadi_int width,
    casadi_int g) {
  return groups==1 ? width : group[g+1];
}
/* violation = impulse - projection of z = impulse - speed/mobility, of one contact */
static void casadi_violation(const casadi_real* impulse, const casadi_real* speed,
    const casadi_real* mobility, const casadi_real* friction, casadi_real minimum,
    const int* group, casadi_int groups, casadi_int width, casadi_real* violation) {
  casadi_int g, a, begin, end;
  casadi_real pressure, length, limit, share;
  pressure = impulse[0] - speed[0]/mobility[0];
  if (!(pressure>minimum)) pressure = minimum;
  violation[0] = impulse[0] - pressure;
  for (g=0; g<groups; ++g) {
    begin = casadi_begin(group, groups, g);
    end = casadi_end(group, groups, width, g);
    length = 0;
    for (a=begin; a<end; ++a) {
      violation[a] = impulse[a] - speed[a]/mobility[a];
      length += violation[a]*violation[a];
    }
    length = sqrt(length);
    limit = friction[g]*pressure;
    share = length>limit ? limit/length : 1.0;
    for (a=begin; a<end; ++a) violation[a] = impulse[a] - share*violation[a];
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
      groups, width, violation);
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
  casadi_int g, a, b, begin, end;
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
    begin = casadi_begin(group, groups, g);
    end = casadi_end(group, groups, width, g);
    length = 0;
    for (a=begin; a<end; ++a) length += z[a]*z[a];
    length = sqrt(length);
    limit = friction[g]*pressure;
    if (length>limit || friction[g]==0) {
      if (!(length>0)) length = 1;
      for (a=begin; a<end; ++a) {
        direction = z[a]/length;
        for (b=begin; b<end; ++b) {
          slip = (a==b ? 1.0 : 0.0) - direction*z[b]/length;
          slip = (a==b ? 1.0 : 0.0) - limit/length*slip;
          own[a*width+b] = slip;
          coupled[a*width+b] = ((a==b ? 1.0 : 0.0) - slip)/mobility[a];
        }
        own[a*width] = -pressed*friction[g]*direction;
        coupled[a*width] = pressed*friction[g]*direction/mobility[0];
      }
    } else {
      for (a=begin; a<end; ++a) coupled[a*width+a] = 1/mobility[a];
    }
  }
}
/* both = own \ both for the equations of a contact, whose normal component depends on itself alone, and
   the components of a group, at most two, on the normal one and each other; zero if these are singular */
static int casadi_eliminate_contact(const casadi_real* own, casadi_real* both, const int* group,
    casadi_int groups, casadi_int width, casadi_int columns) {
  casadi_int g, a, b, c;
  casadi_real share = 1/own[0], x, y, one, other;
  if (!(fabs(own[0])>0)) return 0;
  for (c=0; c<columns; ++c) both[c] = both[c]*share;
  for (g=0; g<groups; ++g) {
    a = casadi_begin(group, groups, g);
    b = casadi_end(group, groups, width, g) - 1;
    one = own[a*width+b];
    other = own[b*width+a];
    if (a==b) other = 0;
    share = own[a*width+a]*own[b*width+b];
    if (a==b) share = own[a*width+a];
    share = share - one*other;
    if (!(fabs(share)>0)) return 0;
    share = 1/share;
    for (c=0; c<columns; ++c) {
      x = both[a*columns+c] - own[a*width]*both[c];
      y = both[b*columns+c] - own[b*width]*both[c];
      if (a==b) both[a*columns+c] = x*share;
      else {
        both[a*columns+c] = (own[b*width+b]*x - one*y)*share;
        both[b*columns+c] = (own[a*width+a]*y - other*x)*share;
      }
    }
  }
  return 1;
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
/* impulses in their cones: those beyond by less than the tolerance are shortened */
static void casadi_shorten(const casadi_real** arg, casadi_real* impulse, const casadi_int* iw) {
  const int* group = (const int*) arg[GROUP_STARTS];
  casadi_int i, g, a, width = iw[COMPONENTS];
  casadi_real length, limit;
  for (i=0; i<iw[CONTACTS]; ++i) {
    if (!(impulse[i*width]>0)) impulse[i*width] = 0;
    for (g=0; g<iw[GROUPS]; ++g) {
      length = 0;
      for (a=group[g]; a<group[g+1]; ++a) length += impulse[i*width+a]*impulse[i*width+a];
      length = sqrt(length);
      limit = arg[FRICTION][i*iw[GROUPS]+g]*impulse[i*width];
      if (!(length>limit)) continue;
      for (a=group[g]; a<group[g+1]; ++a) {
        impulse[i*width+a] = impulse[i*width+a]*(limit/length);
      }
    }
  }
}
