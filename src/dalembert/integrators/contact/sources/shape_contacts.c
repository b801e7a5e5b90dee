/* Contacts of balls, hulls and walls that are near each other, on free bodies */
/* largest speeds of the centres of balls and walls, and of points of hulls, by speeds of the bodies,
   if larger than those before */
static void casadi_fastest(const casadi_real** arg, const casadi_int* iw, const casadi_real* v,
    casadi_real* largest) {
  const int* body = (const int*) arg[BODY_OF_SHAPE];
  const int* start = (const int*) arg[BODY_STARTS];
  const int* place = (const int*) arg[PLACES];
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  const casadi_real* shape;
  casadi_int width = iw[BLOCK_SIZE], s, c, a, size;
  casadi_real twist[6], arm[3], turned[3], speed;
  for (s=0; s<iw[SHAPES]; ++s) {
    if (body[s]<0) continue;
    size = start[body[s]+1] - start[body[s]];
    shape = arg[SHAPE_VELOCITIES] + 6*width*s;
    for (a=0; a<6; ++a) {
      twist[a] = 0;
      for (c=0; c<size; ++c) twist[a] += shape[a*width+c]*v[start[body[s]]+c];
    }
    if (sizes[HULLS]) {
      speed = sqrt(casadi_dot(twist, twist));
      speed += arg[ARMS][s]*sqrt(casadi_dot(twist + 3, twist + 3));
      if (!(speed<=largest[1])) largest[1] = speed;
    }
    if (place[5*s+NUMBER]<0) continue;
    casadi_between(arg[REFERENCES] + 3*s, arg[CORNERS] + 3*place[5*s+CORNERS], arm);
    casadi_cross(twist + 3, arm, turned);
    for (a=0; a<3; ++a) turned[a] += twist[a];
    speed = sqrt(casadi_dot(turned, turned));
    if (!(speed<=largest[0])) largest[0] = speed;
  }
}
/* whether the list contains all pairs within reach: centres moved little since it was made */
static int casadi_listed(const casadi_real** arg, const casadi_int* iw, casadi_real reach) {
  const casadi_real* normal = arg[NORMALS];
  const casadi_real* old = arg[LISTED_CENTERS];
  const casadi_real* old_normal = arg[LISTED_NORMALS];
  const int* place = (const int*) arg[PLACES];
  casadi_real* center = (casadi_real*) arg[CENTERS];
  casadi_int shapes = iw[SHAPES], walls = iw[SHAPES] - iw[BALLS_AND_HULLS], s, a, k, corners, same = 1;
  const casadi_real* corner;
  casadi_real largest = 0, moved[3];
  for (s=0; s<3*walls; ++s) {
    if (normal[s]!=old_normal[s]) same = 0;
  }
  for (s=0; s<shapes; ++s) {
    corner = arg[CORNERS] + 3*place[5*s+CORNERS];
    corners = place[5*s]<0 ? 1 : ((const int*) arg[FORMS])[place[5*s]];
    for (a=0; a<3; ++a) {
      center[3*s+a] = 0;
      for (k=0; k<corners; ++k) center[3*s+a] += corner[3*k+a];
      center[3*s+a] = center[3*s+a]/corners;
    }
    casadi_between(old + 3*s, center + 3*s, moved);
    if (!(casadi_dot(moved, moved)<=largest)) largest = casadi_dot(moved, moved);
  }
  return same && reach + 2*sqrt(largest)<=arg[LIMITS][REACH];
}
/* rows of X of a contact of shapes i and j */
static void casadi_response_rows(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int contact, casadi_int i, casadi_int j) {
  const casadi_real* directions = arg[DIRECTIONS];
  casadi_real* responses = (casadi_real*) arg[RESPONSES];
  const int* row = (const int*) arg[DIRECTION_ROWS];
  const int* start = (const int*) arg[BODY_STARTS];
  const casadi_real* inverse;
  casadi_int width = iw[COMPONENTS], widest = iw[BLOCK_SIZE], a, s, k, c, body, size, next;
  casadi_real sum;
  for (a=0; a<width; ++a) {
    next = row[contact*width+a];
    for (s=0; s<2; ++s) {
      body = ((const int*) arg[BODY_OF_SHAPE])[s==0 ? i : j];
      if (body<0) continue;
      size = start[body+1] - start[body];
      inverse = res[INVERSES] + body*widest*widest;
      for (k=0; k<size; ++k) {
        sum = 0;
        for (c=0; c<size; ++c) sum += inverse[k*size+c]*directions[next+c];
        responses[next+k] = sum;
      }
      next += size;
    }
  }
}
/* the tangents of another normal, turned with it about an axis perpendicular to both by the smallest
   angle: so they do not depend on the axes of the model, and do not spin about the normal. In the
   plane, and for normals more than a right angle apart, they are those of the direction */
static void casadi_turned_tangents(casadi_real* direction, const casadi_real* normal,
    casadi_int dimension) {
  casadi_real other[9], along = casadi_dot(normal, direction), share;
  casadi_int a, k;
  casadi_tangents(direction, dimension);
  if (dimension==2 || normal==direction || !(along>0)) return;
  for (k=0; k<3; ++k) other[k] = normal[k];
  casadi_tangents(other, dimension);
  for (a=1; a<3; ++a) {
    share = casadi_dot(direction, other + 3*a)/(1 + along);
    for (k=0; k<3; ++k) direction[3*a+k] = other[3*a+k] - share*(direction[k] + normal[k]);
  }
}
/* rows of W of a contact of shapes i and j, appended behind those of the contacts before, with the
   tangents of a normal; levers of balls and walls are those of the surfaces, apart by the gap from the
   place halfway between them */
static void casadi_direction_rows(const casadi_real** arg, const casadi_int* iw,
    casadi_int contact, casadi_int i, casadi_int j, casadi_real* direction, const casadi_real* normal,
    const casadi_real* place, casadi_real gap) {
  casadi_real* directions = (casadi_real*) arg[DIRECTIONS];
  int* row = (int*) arg[DIRECTION_ROWS];
  int* column = (int*) arg[DIRECTION_COLUMNS];
  const int* start = (const int*) arg[BODY_STARTS];
  casadi_int width = iw[COMPONENTS], widest = iw[BLOCK_SIZE], dimension = iw[DIMENSION], a, b, s, k, shape,
    body, size;
  casadi_int next = row[contact*width], turn;
  const int* number = (const int*) arg[PLACES];
  casadi_real arm[3], half = gap>0 && number[5*i+NUMBER]>=0 && number[5*j+NUMBER]>=0 ? gap/2 : 0.0;
  const casadi_real* along;
  casadi_turned_tangents(direction, normal, dimension);
  for (a=0; a<width; ++a) {
    turn = a - dimension;
    along = direction + 3*a;
    if (turn>=0) along = direction + 3*(turn==2 ? 0 : turn + 1);
    if (turn>=0 && dimension==2) along = direction + 6;
    for (s=0; s<2; ++s) {
      shape = s==0 ? i : j;
      body = ((const int*) arg[BODY_OF_SHAPE])[shape];
      if (body<0) continue;
      size = start[body+1] - start[body];
      for (b=0; b<3; ++b) {
        arm[b] = place[b] + (s ? half : -half)*direction[b] - arg[REFERENCES][3*shape+b];
      }
      casadi_lever(arg[SHAPE_VELOCITIES] + 6*widest*shape, widest, size, along, arm, turn>=0, s ? 1.0 : -1.0,
        directions + next);
      for (k=0; k<size; ++k) column[next+k] = start[body] + k;
      next += size;
    }
    row[contact*width+a+1] = next;
  }
}
/* gap of a contact at a position, by its description */
static casadi_real casadi_described_gap(const casadi_real** arg, const casadi_int* iw,
    const int* contact, casadi_real* direction, casadi_real* point) {
  const int* place = (const int*) arg[PLACES];
  const int* forms = (const int*) arg[FORMS];
  const casadi_real* radius = arg[RADII];
  casadi_int a, i = contact[SHAPE], j = contact[OTHER_SHAPE];
  const casadi_real* x = arg[CORNERS] + 3*place[5*i+CORNERS];
  const casadi_real* y = arg[CORNERS] + 3*place[5*j+CORNERS];
  if (contact[KIND]==0) {
    for (a=0; a<3; ++a) direction[a] = arg[NORMALS][3*(i-iw[BALLS_AND_HULLS])+a];
    return casadi_wall_gap(x, y + 3*contact[OTHER_FEATURE], radius[j], direction, point);
  }
  if (contact[KIND]==2) {
    return casadi_ball_gap(x + 3*contact[FEATURE], radius[i], y + 3*contact[OTHER_FEATURE], radius[j],
      direction, point);
  }
  return casadi_feature_gap(contact[KIND], forms + place[5*i], x, arg[AXES] + 3*place[5*i+AXES], radius[i],
    contact[FEATURE], forms + place[5*j], y, radius[j], contact[OTHER_FEATURE], iw[DIMENSION], direction,
    point);
}
/* place of a key on the path, or -1 */
static casadi_int casadi_on_path(const casadi_real** arg, casadi_int key) {
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  const casadi_int* on_path = (const casadi_int*) arg[PATH_KEYS];
  casadi_int k;
  for (k=0; k<sizes[PATH]; ++k) {
    if (on_path[k]==key) return k;
  }
  return -1;
}
/* means over the path in the rows of W of a contact */
static void casadi_take_means(const casadi_real** arg, const casadi_int* iw, casadi_int contact,
    casadi_int slot) {
  casadi_real* directions = (casadi_real*) arg[DIRECTIONS];
  const int* row = (const int*) arg[DIRECTION_ROWS];
  casadi_int a, c, width = iw[COMPONENTS], widest = 2*iw[BLOCK_SIZE], first;
  for (a=0; a<width; ++a) {
    first = row[contact*width+a];
    for (c=first; c<row[contact*width+a+1]; ++c) {
      directions[c] = arg[PATH_MEANS][(slot*width+a)*widest+c-first];
    }
  }
}
/* append a contact with a description, a key and the impulse of this key */
static void casadi_add_contact(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    const int* contact, casadi_int key, casadi_real gap, casadi_real* direction,
    const casadi_real* place) {
  const int* law = (const int*) arg[LAW_OF_PAIR];
  const int* row = (const int*) arg[DIRECTION_ROWS];
  const int* column = (const int*) arg[DIRECTION_COLUMNS];
  const int* table = (const int*) arg[KEY_TABLE];
  const casadi_int* last = (const casadi_int*) arg[LAST_KEYS];
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  casadi_real* friction = (casadi_real*) arg[FRICTION];
  casadi_int count = iw[CONTACTS], width = iw[COMPONENTS], groups = iw[GROUPS], g, a, r, slot,
    pair = contact[PAIR];
  iw[CONTACTS] = count + 1;
  if (count>=iw[MAX_CONTACTS]) return;
  casadi_direction_rows(arg, iw, count, contact[SHAPE], contact[OTHER_SHAPE], direction, direction, place,
    gap);
  ((casadi_real*) arg[GAPS])[count] = gap;
  res[GAPS][count] = gap>arg[LIMITS][LEAST_GAP] ? gap : arg[LIMITS][LEAST_GAP];
  ((int*) res[PAIRS])[count] = pair;
  ((casadi_int*) arg[KEYS])[count] = key;
  for (a=0; a<6; ++a) ((int*) arg[DESCRIPTIONS])[6*count+a] = contact[a];
  for (g=0; g<groups; ++g) friction[count*groups+g] = arg[LAWS][law[pair]*(2+groups)+2+g];
  slot = table[casadi_slot(table, sizes[SLOTS], last, key)];
  for (a=0; a<width; ++a) {
    r = count*width + a;
    res[VELOCITY_BEFORE][r] = casadi_row(arg[DIRECTIONS], column, row[r], row[r+1], arg[SPEEDS]);
    res[VELOCITY_FREE][r] = casadi_row(arg[DIRECTIONS], column, row[r], row[r+1], res[FREE_SPEEDS]);
    res[IMPULSE][r] = slot<0 ? 0.0 : res[LAST_IMPULSES][slot*width+a];
  }
}
/* contacts of hulls i and j of a pair of the list; the smallest gap, or zero */
static casadi_real casadi_hull_contacts(const casadi_real** arg, casadi_real** res,
    casadi_int* iw, casadi_int pair, casadi_int i, casadi_int j, casadi_real reach) {
  const int* place = (const int*) arg[PLACES];
  const int* forms = (const int*) arg[FORMS];
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  const casadi_real* corners = arg[CORNERS];
  const casadi_real* axes = arg[AXES];
  const casadi_real* radius = arg[RADII];
  const int* a = forms + place[5*i];
  const int* b = forms + place[5*j];
  const casadi_real* x = corners + 3*place[5*i+CORNERS];
  const casadi_real* y = corners + 3*place[5*j+CORNERS];
  const casadi_real* n = axes + 3*place[5*i+AXES];
  const casadi_real* m = axes + 3*place[5*j+AXES];
  int* rows = (int*) arg[FEATURES];
  int contact[6];
  casadi_int r, count, one, two, key, rounded = radius[i]>0 || radius[j]>0;
  casadi_real gap, deepest = 0, limit = reach + radius[i] + radius[j], direction[9], point[3];
  if (iw[DIMENSION]==2) count = casadi_planar_features(a, x, n, b, y, m, rounded, limit, rows);
  else {
    count = casadi_spatial_features(a, x, n, b, y, m, rounded, limit, rows, (casadi_real*) arg[HULL_WORK]);
  }
  for (r=0; r<count; ++r) {
    one = rows[4*r+1] ? j : i;
    two = rows[4*r+1] ? i : j;
    contact[KIND] = rows[4*r];
    contact[SHAPE] = one;
    contact[FEATURE] = rows[4*r+2];
    contact[OTHER_SHAPE] = two;
    contact[OTHER_FEATURE] = rows[4*r+3];
    contact[PAIR] = pair;
    gap = casadi_described_gap(arg, iw, contact, direction, point);
    if (!(gap>=deepest)) deepest = gap;
    if (gap>reach) continue;
    key = (rows[4*r]*sizes[FEATURES] + place[5*one+FEATURES] + contact[FEATURE])*sizes[FEATURES]
      + place[5*two+FEATURES] + contact[OTHER_FEATURE];
    casadi_add_contact(arg, res, iw, contact, sizes[OFFSET] + key, gap, direction, point);
  }
  return deepest;
}
/* contacts of a wall i with the corners of a hull or with a ball j; the smallest gap, or zero */
static casadi_real casadi_wall_contacts(const casadi_real** arg, casadi_real** res,
    casadi_int* iw, casadi_int pair, casadi_int i, casadi_int j, const casadi_real* reach) {
  const int* place = (const int*) arg[PLACES];
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  casadi_int k, ball = place[5*j+NUMBER]>=0, key;
  casadi_int count = ball ? 1 : ((const int*) arg[FORMS])[place[5*j]];
  casadi_real gap, deepest = 0, direction[9], point[3];
  int contact[6];
  contact[KIND] = 0;
  contact[SHAPE] = i;
  contact[FEATURE] = 0;
  contact[OTHER_SHAPE] = j;
  contact[PAIR] = pair;
  for (k=0; k<count; ++k) {
    contact[OTHER_FEATURE] = k;
    gap = casadi_described_gap(arg, iw, contact, direction, point);
    if (!(gap>=deepest)) deepest = gap;
    if (gap>reach[ball ? 0 : 1]) continue;
    key = sizes[OFFSET] + place[5*i+FEATURES]*sizes[FEATURES] + place[5*j+FEATURES] + k;
    if (ball) key = place[5*i+NUMBER]*sizes[NUMBERED] + place[5*j+NUMBER];
    casadi_add_contact(arg, res, iw, contact, key, gap, direction, point);
  }
  return deepest;
}
/* axes of all hulls */
static void casadi_all_axes(const casadi_real** arg, const casadi_int* iw) {
  const int* place = (const int*) arg[PLACES];
  const int* forms = (const int*) arg[FORMS];
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  casadi_int i;
  for (i=0; i<iw[BALLS_AND_HULLS] && sizes[HULLS]; ++i) {
    casadi_axes(forms + place[5*i], arg[CORNERS] + 3*place[5*i+CORNERS], iw[DIMENSION],
      (casadi_real*) arg[AXES] + 3*place[5*i+AXES]);
  }
}
/* contacts within reach, with their gaps, laws and velocities, then those of the path beyond it; the
   smallest gap, or zero */
static casadi_real casadi_contacts(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    const casadi_real* reach) {
  const int* place = (const int*) arg[PLACES];
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  const casadi_int* keys = (const casadi_int*) arg[KEYS];
  const casadi_int* on_path = (const casadi_int*) arg[PATH_KEYS];
  const int* body = (const int*) arg[BODY_OF_SHAPE];
  casadi_int e, i, j, k;
  casadi_real deepest = 0, gap, direction[9], point[3];
  int contact[6];
  ((int*) arg[DIRECTION_ROWS])[0] = 0;
  iw[CONTACTS] = 0;
  casadi_index((int*) arg[KEY_TABLE], sizes[SLOTS], (const casadi_int*) arg[LAST_KEYS], sizes[LAST_IMPULSES]);
  casadi_all_axes(arg, iw);
  for (e=0; e<iw[PAIRS]; ++e) {
    i = ((const int*) arg[FIRST_SHAPE])[e];
    j = ((const int*) arg[SECOND_SHAPE])[e];
    if (body[i]<0 && body[j]<0) continue;
    if (i>=iw[BALLS_AND_HULLS]) {
      gap = casadi_wall_contacts(arg, res, iw, e, i, j, reach);
    } else if (place[5*i+NUMBER]<0 || place[5*j+NUMBER]<0) {
      gap = casadi_hull_contacts(arg, res, iw, e, i, j, reach[1]);
    } else {
      contact[KIND] = 2;
      contact[SHAPE] = i;
      contact[FEATURE] = 0;
      contact[OTHER_SHAPE] = j;
      contact[OTHER_FEATURE] = 0;
      contact[PAIR] = e;
      gap = casadi_described_gap(arg, iw, contact, direction, point);
      if (!(gap>reach[0])) {
        casadi_add_contact(arg, res, iw, contact, place[5*i+NUMBER]*sizes[NUMBERED] + place[5*j+NUMBER], gap,
          direction, point);
      }
    }
    if (!(gap>=deepest)) deepest = gap;
  }
  for (k=0; k<sizes[PATH]; ++k) {
    for (i=0; i<iw[CONTACTS] && i<iw[MAX_CONTACTS] && keys[i]!=on_path[k]; ++i) {}
    if (i<iw[CONTACTS]) continue;
    gap = casadi_described_gap(arg, iw, (const int*) arg[PATH_DESCRIPTIONS] + 6*k, direction, point);
    casadi_add_contact(arg, res, iw, (const int*) arg[PATH_DESCRIPTIONS] + 6*k, on_path[k], gap, direction,
      point);
  }
  return deepest;
}
/* whether the speed at the contact, after the fall over the gap, is that of an impact */
static int casadi_fast(casadi_real gap, casadi_real before, casadi_real free, casadi_real h,
    casadi_real forced, casadi_real slow, casadi_real slowest) {
  casadi_real fall = before - free, least = slow*forced;
  if (!(fall>0)) fall = 0;
  if (!(gap>0)) gap = 0;
  if (slowest*gap/h>least) least = slowest*gap/h;
  return before*before + 2*fall*gap/h>least*least;
}
/* the largest change of a normal speed by forces at the bodies of each contact, by their first
   speeds */
static void casadi_changes(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  casadi_real* largest = res[BODY_CHANGES];
  const int* pair = (const int*) res[PAIRS];
  casadi_int i, j, s, body;
  casadi_real change;
  for (j=0; j<iw[SPEEDS]; ++j) largest[j] = 0;
  for (i=0; i<iw[CONTACTS]; ++i) {
    change = fabs(res[VELOCITY_FREE][i*iw[COMPONENTS]] - res[VELOCITY_BEFORE][i*iw[COMPONENTS]]);
    for (s=0; s<2; ++s) {
      body = ((const int*) arg[BODY_OF_SHAPE])[((const int*) arg[FIRST_SHAPE+s])[pair[i]]];
      if (body<0) continue;
      j = ((const int*) arg[BODY_STARTS])[body];
      if (!(change<=largest[j])) largest[j] = change;
    }
  }
}
/* the largest change of a normal speed by forces at the bodies of a contact */
static casadi_real casadi_change(const casadi_real** arg, casadi_real** res, casadi_int i) {
  casadi_int s, body;
  casadi_real largest = 0, change;
  for (s=0; s<2; ++s) {
    body = ((const int*) arg[BODY_OF_SHAPE])[((const int*) arg[FIRST_SHAPE+s])[((const int*) res[PAIRS])[i]]];
    if (body<0) continue;
    change = res[BODY_CHANGES][((const int*) arg[BODY_STARTS])[body]];
    if (!(change<=largest)) largest = change;
  }
  return largest;
}
/* whether a contact has an impact, by the changes at its bodies */
static int casadi_strikes(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int i) {
  casadi_int r = i*iw[COMPONENTS];
  return casadi_fast(res[GAPS][i], res[VELOCITY_BEFORE][r], res[VELOCITY_FREE][r], arg[LIMITS][LENGTH],
    casadi_change(arg, res, i), arg[SHARES][SLOW], arg[SHARES][SLOWEST]);
}
/* directions of the contacts: those in the middle of the step, means over its path, or, of impacts, those
   at its start, as all of implicit steps; with them the velocities at the end of the step, the clearance
   of gaps that turn, the rows of X, and a mask of the contacts that leave their faces */
static void casadi_take_middle(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const casadi_real* ahead[65];
  const casadi_int* key = (const casadi_int*) arg[KEYS];
  const int* contact = (const int*) arg[DESCRIPTIONS];
  const int* row = (const int*) arg[DIRECTION_ROWS];
  const int* column = (const int*) arg[DIRECTION_COLUMNS];
  int* kept = (int*) res[START_DIRECTIONS];
  int* leaves = (int*) res[LEAVING];
  casadi_int i, r, slot, width = iw[COMPONENTS];
  casadi_real gap, first, direction[9], normal[9], point[3], place[3], middle, end, clearance,
    h = arg[LIMITS][LENGTH];
  for (i=0; i<65; ++i) ahead[i] = arg[i];
  ahead[CORNERS] = arg[CORNERS_AHEAD];
  ahead[REFERENCES] = arg[REFERENCES_AHEAD];
  ahead[NORMALS] = arg[NORMALS_AHEAD];
  ahead[SHAPE_VELOCITIES] = arg[VELOCITIES_AHEAD];
  ahead[AXES] = arg[AXES_AHEAD];
  casadi_all_axes(ahead, iw);
  casadi_changes(arg, res, iw);
  for (i=0; i<iw[CONTACTS]; ++i, contact+=6) {
    r = i*width;
    kept[i] = res[VELOCITY_BEFORE][r]<0 && -h*res[VELOCITY_BEFORE][r]>arg[LIMITS][LEAST_TRAVEL]
      && casadi_strikes(arg, res, iw, i);
    slot = casadi_on_path(arg, key[i]);
    leaves[i] = slot<0 && contact[KIND]==1 && !(res[IMPULSE][r]>0)
      && casadi_leaves(arg, ahead, contact, iw[DIMENSION]);
    if (arg[LIMITS][THETA]==1) {
      kept[i] = 0;
      casadi_response_rows(arg, res, iw, i, contact[SHAPE], contact[OTHER_SHAPE]);
      continue;
    }
    first = casadi_described_gap(arg, iw, contact, normal, place);
    gap = casadi_described_gap(ahead, iw, contact, direction, point);
    casadi_direction_rows(ahead, iw, i, contact[SHAPE], contact[OTHER_SHAPE], direction, normal, point, gap);
    middle = casadi_row(arg[DIRECTIONS], column, row[r], row[r+1], arg[SPEEDS]);
    end = casadi_row(arg[DIRECTIONS], column, row[r], row[r+1], res[FREE_SPEEDS]);
    if (kept[i]) {
      kept[i] = !(gap>=0 && res[GAPS][i] + h*(middle + end)/2>=0);
      if (!(casadi_dot(normal, direction)>0)) kept[i] = 1;
    }
    if (slot>=0) {
      casadi_take_means(arg, iw, i, slot);
      res[GAPS][i] = arg[PATH_GAPS][slot];
    } else if (leaves[i]) {
      kept[i] = 0;
      res[GAPS][i] += 10*res[STATUS][REACH];
    } else if (kept[i]) {
      casadi_direction_rows(arg, iw, i, contact[SHAPE], contact[OTHER_SHAPE], normal, normal, place, first);
    } else if (h*fabs(middle - res[VELOCITY_BEFORE][r])>arg[LIMITS][LEAST_TURN]) {
      middle = h*fabs(middle - res[VELOCITY_BEFORE][r]);
      clearance = arg[LIMITS][CLEARANCE];
      while (0.1*clearance>arg[SHARES][TURNS]*middle) clearance = 0.1*clearance;
      res[GAPS][i] = res[GAPS][i]>clearance ? res[GAPS][i] - clearance : 0.0;
    }
    for (r=i*width; r<(i+1)*width && (slot>=0 || !kept[i]); ++r) {
      middle = casadi_row(arg[DIRECTIONS], column, row[r], row[r+1], arg[SPEEDS]);
      if (kept[i]) res[VELOCITY_BEFORE][r] = middle;
      res[VELOCITY_FREE][r] = casadi_row(arg[DIRECTIONS], column, row[r], row[r+1], res[FREE_SPEEDS]) + middle
        - res[VELOCITY_BEFORE][r];
    }
    casadi_response_rows(arg, res, iw, i, contact[SHAPE], contact[OTHER_SHAPE]);
  }
}
/* gaps of the contacts of the path at a position and, with a weight, the part of this position in the
   means of their directions, whose tangents are those of the first position with a weight */
static void casadi_path(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const casadi_int* sizes = (const casadi_int*) arg[SIZES];
  const int* contact;
  const int* row = (const int*) arg[DIRECTION_ROWS];
  const int* column = (const int*) arg[DIRECTION_COLUMNS];
  casadi_real* mean = (casadi_real*) arg[PATH_MEANS];
  casadi_real* gaps = (casadi_real*) arg[PATH_GAPS];
  casadi_real* normal;
  casadi_int k, a, c, width = iw[COMPONENTS], widest = 2*iw[BLOCK_SIZE];
  casadi_real direction[9], point[3], share;
  casadi_all_axes(arg, iw);
  ((int*) arg[DIRECTION_ROWS])[0] = 0;
  for (k=0; k<sizes[PATH]; ++k) {
    contact = (const int*) arg[PATH_DESCRIPTIONS] + 6*k;
    gaps[k] = casadi_described_gap(arg, iw, contact, direction, point);
    if (arg[LIMITS][PATH_WEIGHT]==0) continue;
    normal = (casadi_real*) arg[PATH_NORMALS] + 3*k;
    if (casadi_dot(normal, normal)==0) {
      for (a=0; a<3; ++a) normal[a] = direction[a];
    }
    casadi_direction_rows(arg, iw, 0, contact[SHAPE], contact[OTHER_SHAPE], direction, normal, point,
      gaps[k]);
    for (a=0; a<width; ++a) {
      for (c=row[a]; c<row[a+1]; ++c) {
        share = a==0 ? arg[PATH_SHARES][column[c]] : 1.0;
        mean[(k*width+a)*widest+c-row[a]] += arg[LIMITS][PATH_WEIGHT]*share*arg[DIRECTIONS][c];
      }
    }
  }
}
