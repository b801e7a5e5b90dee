/* Contacts of balls, hulls and walls that are near each other, on free bodies. The places of a shape
   are those of its form, corners and axes, its first feature, and its number among balls and walls,
   -1 for others. Sizes are the numbers of impulses before, of features, of balls and walls, the
   offset of the keys of hulls, the size of the table of keys, and whether there are hulls */
/* largest speeds of the centres of balls and walls, and of points of hulls, by speeds of the bodies,
   if larger than those before */
static void casadi_fastest(const casadi_real** arg, const casadi_int* iw, const casadi_real* v,
    casadi_real* largest) {
  const int* body = (const int*) arg[29];
  const int* start = (const int*) arg[30];
  const int* place = (const int*) arg[38];
  const casadi_int* sizes = (const casadi_int*) arg[47];
  const casadi_real* shape;
  casadi_int width = iw[9], s, c, a, size;
  casadi_real twist[6], arm[3], turned[3], speed;
  for (s=0; s<iw[14]; ++s) {
    if (body[s]<0) continue;
    size = start[body[s]+1] - start[body[s]];
    shape = arg[27] + 6*width*s;
    for (a=0; a<6; ++a) {
      twist[a] = 0;
      for (c=0; c<size; ++c) twist[a] += shape[a*width+c]*v[start[body[s]]+c];
    }
    if (sizes[5]) {
      speed = sqrt(casadi_dot(twist, twist));
      speed += arg[49][s]*sqrt(casadi_dot(twist + 3, twist + 3));
      if (!(speed<=largest[1])) largest[1] = speed;
    }
    if (place[5*s+4]<0) continue;
    casadi_between(arg[24] + 3*s, arg[40] + 3*place[5*s+1], arm);
    casadi_cross(twist + 3, arm, turned);
    for (a=0; a<3; ++a) turned[a] += twist[a];
    speed = sqrt(casadi_dot(turned, turned));
    if (!(speed<=largest[0])) largest[0] = speed;
  }
}
/* whether the list contains all pairs within reach: centres moved little since it was made */
static int casadi_listed(const casadi_real** arg, const casadi_int* iw, casadi_real reach) {
  const casadi_real* normal = arg[25];
  const casadi_real* old = arg[34];
  const casadi_real* old_normal = arg[35];
  const int* place = (const int*) arg[38];
  casadi_real* center = (casadi_real*) arg[48];
  casadi_int shapes = iw[14], walls = iw[14] - iw[15], s, a, k, corners, same = 1;
  const casadi_real* corner;
  casadi_real largest = 0, moved[3];
  for (s=0; s<3*walls; ++s) {
    if (normal[s]!=old_normal[s]) same = 0;
  }
  for (s=0; s<shapes; ++s) {
    corner = arg[40] + 3*place[5*s+1];
    corners = place[5*s]<0 ? 1 : ((const int*) arg[39])[place[5*s]];
    for (a=0; a<3; ++a) {
      center[3*s+a] = 0;
      for (k=0; k<corners; ++k) center[3*s+a] += corner[3*k+a];
      center[3*s+a] = center[3*s+a]/corners;
    }
    casadi_between(old + 3*s, center + 3*s, moved);
    if (!(casadi_dot(moved, moved)<=largest)) largest = casadi_dot(moved, moved);
  }
  return same && reach + 2*sqrt(largest)<=arg[36][3];
}
/* rows of W and X of a contact of shapes i and j, appended behind those of the contacts before;
   levers are those of the surfaces, apart by the gap from the place halfway between them */
static void casadi_contact_rows(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int contact, casadi_int i, casadi_int j, casadi_real* direction,
    const casadi_real* place, casadi_real gap) {
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
      shape = s==0 ? i : j;
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
/* append a contact of shapes i and j of a pair of the list, with the impulse of its key */
static void casadi_add_contact(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_int pair, casadi_int i, casadi_int j, casadi_int key, casadi_real gap,
    casadi_real* direction, const casadi_real* place) {
  const int* law = (const int*) arg[33];
  const int* row = (const int*) arg[9];
  const int* column = (const int*) arg[10];
  const int* table = (const int*) arg[46];
  const casadi_int* last = (const casadi_int*) arg[44];
  const casadi_int* sizes = (const casadi_int*) arg[47];
  casadi_real* friction = (casadi_real*) arg[3];
  casadi_int count = iw[0], width = iw[1], groups = iw[2], g, a, r, slot;
  iw[0] = count + 1;
  if (count>=iw[19]) return;
  casadi_contact_rows(arg, res, iw, count, i, j, direction, place, gap);
  res[22][count] = gap>0 ? gap : 0.0;
  ((int*) res[23])[count] = pair;
  ((casadi_int*) arg[43])[count] = key;
  for (g=0; g<groups; ++g) friction[count*groups+g] = arg[28][law[pair]*(2+groups)+2+g];
  slot = table[casadi_slot(table, sizes[4], last, key)];
  for (a=0; a<width; ++a) {
    r = count*width + a;
    res[24][r] = casadi_row(arg[0], column, row[r], row[r+1], arg[22]);
    res[25][r] = casadi_row(arg[0], column, row[r], row[r+1], res[19]);
    res[0][r] = slot<0 ? 0.0 : res[29][slot*width+a];
  }
}
/* contacts of hulls i and j of a pair of the list; the smallest gap, or zero */
static casadi_real casadi_hull_contacts(const casadi_real** arg, casadi_real** res,
    casadi_int* iw, casadi_int pair, casadi_int i, casadi_int j, casadi_real reach) {
  const int* place = (const int*) arg[38];
  const int* forms = (const int*) arg[39];
  const casadi_int* sizes = (const casadi_int*) arg[47];
  const casadi_real* corners = arg[40];
  const casadi_real* axes = arg[41];
  const casadi_real* radius = arg[26];
  const int* a = forms + place[5*i];
  const int* b = forms + place[5*j];
  const casadi_real* x = corners + 3*place[5*i+1];
  const casadi_real* y = corners + 3*place[5*j+1];
  const casadi_real* n = axes + 3*place[5*i+2];
  const casadi_real* m = axes + 3*place[5*j+2];
  int* rows = (int*) arg[42];
  casadi_int r, count, own, other, key, rounded = radius[i]>0 || radius[j]>0;
  casadi_real gap, deepest = 0, limit = reach + radius[i] + radius[j], direction[9], point[3];
  if (iw[18]==2) count = casadi_planar_features(a, x, n, b, y, m, rounded, limit, rows);
  else count = casadi_spatial_features(a, x, n, b, y, m, rounded, limit, rows, (casadi_real*) arg[50]);
  for (r=0; r<count; ++r) {
    own = rows[4*r+2];
    other = rows[4*r+3];
    key = rows[4*r]*sizes[1];
    if (rows[4*r+1]) {
      gap = casadi_feature_gap(rows[4*r], b, y, m, radius[j], own, a, x, radius[i], other, iw[18],
        direction, point);
      key = (key + place[5*j+3] + own)*sizes[1] + place[5*i+3] + other;
    } else {
      gap = casadi_feature_gap(rows[4*r], a, x, n, radius[i], own, b, y, radius[j], other, iw[18],
        direction, point);
      key = (key + place[5*i+3] + own)*sizes[1] + place[5*j+3] + other;
    }
    if (!(gap>=deepest)) deepest = gap;
    if (gap>reach) continue;
    casadi_add_contact(arg, res, iw, pair, rows[4*r+1] ? j : i, rows[4*r+1] ? i : j,
      sizes[3] + key, gap, direction, point);
  }
  return deepest;
}
/* contacts of a wall i with the corners of a hull or with a ball j; the smallest gap, or zero */
static casadi_real casadi_wall_contacts(const casadi_real** arg, casadi_real** res,
    casadi_int* iw, casadi_int pair, casadi_int i, casadi_int j, const casadi_real* reach) {
  const int* place = (const int*) arg[38];
  const casadi_int* sizes = (const casadi_int*) arg[47];
  const casadi_real* corner = arg[40] + 3*place[5*j+1];
  casadi_int k, a, ball = place[5*j+4]>=0, key;
  casadi_int count = ball ? 1 : ((const int*) arg[39])[place[5*j]];
  casadi_real gap, deepest = 0, direction[9], point[3];
  for (k=0; k<count; ++k) {
    for (a=0; a<3; ++a) direction[a] = arg[25][3*(i-iw[15])+a];
    gap = casadi_wall_gap(arg[40] + 3*place[5*i+1], corner + 3*k, arg[26][j], direction, point);
    if (!(gap>=deepest)) deepest = gap;
    if (gap>reach[ball ? 0 : 1]) continue;
    key = sizes[3] + place[5*i+3]*sizes[1] + place[5*j+3] + k;
    if (ball) key = place[5*i+4]*sizes[2] + place[5*j+4];
    casadi_add_contact(arg, res, iw, pair, i, j, key, gap, direction, point);
  }
  return deepest;
}
/* contacts within reach, with their gaps, laws and velocities; the smallest gap, or zero */
static casadi_real casadi_contacts(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    const casadi_real* reach) {
  const int* place = (const int*) arg[38];
  const int* forms = (const int*) arg[39];
  const casadi_int* sizes = (const casadi_int*) arg[47];
  const casadi_real* corners = arg[40];
  casadi_int e, i, j, key;
  casadi_real deepest = 0, gap, direction[9], point[3];
  ((int*) arg[9])[0] = 0;
  iw[0] = 0;
  casadi_index((int*) arg[46], sizes[4], (const casadi_int*) arg[44], sizes[0]);
  for (i=0; i<iw[15] && sizes[5]; ++i) {
    casadi_axes(forms + place[5*i], corners + 3*place[5*i+1], iw[18],
      (casadi_real*) arg[41] + 3*place[5*i+2]);
  }
  for (e=0; e<iw[17]; ++e) {
    i = ((const int*) arg[31])[e];
    j = ((const int*) arg[32])[e];
    if (i>=iw[15]) {
      gap = casadi_wall_contacts(arg, res, iw, e, i, j, reach);
    } else if (place[5*i+4]<0 || place[5*j+4]<0) {
      gap = casadi_hull_contacts(arg, res, iw, e, i, j, reach[1]);
    } else {
      gap = casadi_ball_gap(corners + 3*place[5*i+1], arg[26][i], corners + 3*place[5*j+1],
        arg[26][j], direction, point);
      key = place[5*i+4]*sizes[2] + place[5*j+4];
      if (!(gap>reach[0])) {
        casadi_add_contact(arg, res, iw, e, i, j, key, gap, direction, point);
      }
    }
    if (!(gap>=deepest)) deepest = gap;
  }
  return deepest;
}
