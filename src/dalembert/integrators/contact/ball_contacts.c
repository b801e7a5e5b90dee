/* Contacts of balls with balls and walls that are near each other, on free bodies */
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
  const casadi_real* inertia = arg[14];
  const int* a_row = (const int*) arg[15];
  const int* a_column = (const int*) arg[16];
  const int* start = (const int*) arg[30];
  casadi_real* inverse = res[20];
  casadi_real* last = res[21];
  casadi_int bodies = iw[16], widest = iw[9], entries = iw[23], b, k, j, size, changed = 0;
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
/* the largest squared speed of a shape by speeds v of the bodies */
static casadi_real casadi_fastest(const casadi_real** arg, const casadi_int* iw,
    const casadi_real* v) {
  const casadi_real* shape = arg[27];
  const int* body = (const int*) arg[29];
  const int* start = (const int*) arg[30];
  casadi_int shapes = iw[14], width = iw[9], s, c, a, size;
  casadi_real largest = 0, square, speed;
  for (s=0; s<shapes; ++s) {
    if (body[s]<0) continue;
    size = start[body[s]+1] - start[body[s]];
    square = 0;
    for (a=0; a<3; ++a) {
      speed = 0;
      for (c=0; c<size; ++c) speed += shape[(6*s+a)*width+c]*v[start[body[s]]+c];
      square += speed*speed;
    }
    if (!(square<=largest)) largest = square;
  }
  return largest;
}
/* whether the list contains all pairs within reach: shapes moved little since it was made */
static int casadi_listed(const casadi_real** arg, const casadi_int* iw, casadi_real reach) {
  const casadi_real* position = arg[24];
  const casadi_real* normal = arg[25];
  const casadi_real* old = arg[34];
  const casadi_real* old_normal = arg[35];
  casadi_int shapes = iw[14], walls = iw[14] - iw[15], s;
  casadi_real largest = 0, x, y, z;
  for (s=0; s<3*walls; ++s) {
    if (normal[s]!=old_normal[s]) return 0;
  }
  for (s=0; s<shapes; ++s) {
    x = position[3*s] - old[3*s];
    y = position[3*s+1] - old[3*s+1];
    z = position[3*s+2] - old[3*s+2];
    if (!(x*x + y*y + z*z<=largest)) largest = x*x + y*y + z*z;
  }
  return reach + 2*sqrt(largest)<=arg[36][3];
}
/* gap of a pair of the list, with the normal and the place halfway between the surfaces */
static casadi_real casadi_gap(const casadi_real** arg, const casadi_int* iw, casadi_int pair,
    casadi_real* normal, casadi_real* place) {
  casadi_int i = ((const int*) arg[31])[pair], j = ((const int*) arg[32])[pair], a;
  casadi_int balls = iw[15];
  const casadi_real* here = arg[24] + 3*i;
  const casadi_real* there = arg[24] + 3*j;
  casadi_real radius = arg[26][j], gap = 0;
  if (i>=balls) {
    for (a=0; a<3; ++a) {
      normal[a] = arg[25][3*(i-balls)+a];
      gap += normal[a]*(there[a] - here[a]);
    }
    gap = gap - radius;
    for (a=0; a<3; ++a) place[a] = there[a] - (radius + gap/2)*normal[a];
    return gap;
  }
  for (a=0; a<3; ++a) {
    normal[a] = there[a] - here[a];
    gap += normal[a]*normal[a];
  }
  gap = sqrt(gap);
  for (a=0; a<3; ++a) normal[a] = normal[a]/gap;
  gap = gap - arg[26][i] - radius;
  for (a=0; a<3; ++a) place[a] = here[a] + (arg[26][i] + gap/2)*normal[a];
  return gap;
}
/* rows of W and X of a contact, appended behind those of the contacts before; levers are those of
   the surfaces, apart by the gap from the place halfway between them */
static void casadi_contact_rows(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int contact, casadi_int pair, casadi_real* direction, const casadi_real* place,
    casadi_real gap) {
  casadi_real* directions = (casadi_real*) arg[0];
  casadi_real* responses = (casadi_real*) arg[1];
  int* row = (int*) arg[9];
  int* column = (int*) arg[10];
  const int* start = (const int*) arg[30];
  casadi_int width = iw[1], widest = iw[9], dimension = iw[18], a, b, s, k, c, shape, body, size;
  casadi_int next = row[contact*width], turn;
  casadi_real arm[3], sum, half = gap>0 ? gap/2 : 0.0;
  const casadi_real* inverse;
  const casadi_real* along;
  casadi_tangents(direction, dimension);
  for (a=0; a<width; ++a) {
    turn = a - dimension;
    along = direction + 3*a;
    if (turn>=0) along = direction + 3*(turn==2 ? 0 : turn + 1);
    if (turn>=0 && dimension==2) along = direction + 6;
    for (s=0; s<2; ++s) {
      shape = s==0 ? ((const int*) arg[31])[pair] : ((const int*) arg[32])[pair];
      body = ((const int*) arg[29])[shape];
      if (body<0) continue;
      size = start[body+1] - start[body];
      for (b=0; b<3; ++b) {
        arm[b] = place[b] + (s ? half : -half)*direction[b] - arg[24][3*shape+b];
      }
      casadi_lever(arg[27] + 6*widest*shape, widest, size, along, arm, turn>=0, s ? 1.0 : -1.0,
        directions + next);
      inverse = res[20] + body*widest*widest;
      for (k=0; k<size; ++k) {
        column[next+k] = start[body] + k;
        sum = 0;
        for (c=0; c<size; ++c) sum += inverse[k*size+c]*directions[next+c];
        responses[next+k] = sum;
      }
      next += size;
    }
    row[contact*width+a+1] = next;
  }
}
