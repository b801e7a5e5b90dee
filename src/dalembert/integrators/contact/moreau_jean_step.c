/* One step of free bodies with balls, hulls and walls by the scheme of Moreau and Jean. The contacts that
   are near each other at its start are stored: directions in res[51] with rows and columns in res[52] and
   res[53], velocities before and at the end without impulses in res[54] and res[55], gaps, keys,
   descriptions and kept directions in res[56] to res[59], normals from the shape with the lower number in
   res[60], and states in res[61]: whether a contact leaves its face (0), is idle (1), active (2), or about
   to be added (3). The speeds at the end are in res[62]. Sizes are, from the tenth one, the numbers of
   stored contacts and of those about to be added, -1 if others are needed, and whether shapes pass through
   each other, contacts may be added, and those about to be added are final */
/* normal of a contact from the shape with the lower number */
static void casadi_signed_normal(const casadi_real** arg, const casadi_int* iw,
    const int* contact, casadi_real* normal) {
  casadi_real direction[9], point[3];
  casadi_int a;
  casadi_described_gap(arg, iw, contact, direction, point);
  for (a=0; a<3; ++a) normal[a] = contact[1]<contact[3] ? direction[a] : -direction[a];
}
/* store all contacts; active are those whose gaps would close within a part of the step */
static void casadi_store(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[47];
  const int* row = (const int*) arg[9];
  const int* contact = (const int*) arg[51];
  int* state = (int*) res[61];
  casadi_int count = iw[0], width = iw[1], rows = iw[0]*iw[1], i, j, a;
  casadi_real forced = 0, fastest = 0, gap, speed;
  casadi_int linear = iw[2]>0 ? ((const int*) arg[13])[1] : 1;
  for (j=0; j<=rows; ++j) ((int*) res[52])[j] = row[j];
  for (j=0; j<row[rows]; ++j) {
    res[51][j] = arg[0][j];
    ((int*) res[53])[j] = ((const int*) arg[10])[j];
  }
  for (j=0; j<rows; ++j) {
    res[54][j] = res[24][j];
    res[55][j] = res[25][j];
  }
  for (i=0; i<count; ++i) {
    gap = arg[45][i];
    res[56][i] = gap;
    ((casadi_int*) res[57])[i] = ((const casadi_int*) arg[43])[i];
    for (a=0; a<6; ++a) ((int*) res[58])[6*i+a] = contact[6*i+a];
    ((int*) res[59])[i] = ((const int*) res[45])[i];
    casadi_signed_normal(arg, iw, contact + 6*i, res[60] + 3*i);
    state[i] = 0;
    if (((const int*) res[50])[i]) continue;
    state[i] = gap + arg[36][12]*arg[36][0]*res[24][i*width]<=arg[36][2] ? 2 : 1;
    speed = fabs(res[25][i*width] - res[24][i*width]);
    if (!(speed<=forced)) forced = speed;
    for (a=i*width; a<i*width+linear; ++a) {
      if (!(fabs(res[24][a])<=fastest)) fastest = fabs(res[24][a]);
      if (!(fabs(res[25][a])<=fastest)) fastest = fabs(res[25][a]);
    }
  }
  sizes[9] = count;
  sizes[12] = arg[36][13]>0 && forced>arg[37][16]*arg[36][1]*fastest;
  res[11][5] = forced;
}
/* the stored contacts that are active or about to be added, with initial impulses by their keys */
static void casadi_gather(const casadi_real** arg, casadi_real** res, casadi_int* iw) {
  const casadi_int* sizes = (const casadi_int*) arg[47];
  const casadi_int* last = (const casadi_int*) arg[44];
  const casadi_int* keys = (const casadi_int*) res[57];
  const int* stored = (const int*) res[52];
  const int* law = (const int*) arg[33];
  const int* contact;
  int* table = (int*) arg[46];
  int* row = (int*) arg[9];
  casadi_int width = iw[1], groups = iw[2], i, j, a, g, n, r, s, next, slot;
  casadi_index(table, sizes[4], last, sizes[0]);
  iw[0] = 0;
  row[0] = 0;
  for (i=0; i<sizes[9]; ++i) {
    if (((const int*) res[61])[i]<2) continue;
    n = iw[0];
    iw[0] = n + 1;
    contact = (const int*) res[58] + 6*i;
    slot = table[casadi_slot(table, sizes[4], last, keys[i])];
    for (a=0; a<width; ++a) {
      r = n*width + a;
      s = i*width + a;
      next = row[r];
      for (j=stored[s]; j<stored[s+1]; ++j, ++next) {
        ((casadi_real*) arg[0])[next] = res[51][j];
        ((int*) arg[10])[next] = ((const int*) res[53])[j];
      }
      row[r+1] = next;
      res[24][r] = res[54][s];
      res[25][r] = res[55][s];
      res[48][r] = res[55][s];
      res[0][r] = slot<0 ? 0.0 : res[29][slot*width+a];
    }
    ((casadi_real*) arg[45])[n] = res[56][i];
    res[22][n] = res[56][i];
    ((casadi_int*) arg[43])[n] = keys[i];
    ((int*) res[45])[n] = ((const int*) res[59])[i];
    ((int*) res[23])[n] = contact[5];
    for (a=0; a<6; ++a) ((int*) arg[51])[6*n+a] = contact[a];
    for (g=0; g<groups; ++g) {
      ((casadi_real*) arg[3])[n*groups+g] = arg[28][law[contact[5]]*(2+groups)+2+g];
    }
    casadi_response_rows(arg, res, iw, n, contact[1], contact[3]);
  }
}
/* change a state of stored contacts into another one */
static void casadi_exchange(casadi_real** res, casadi_int count, int old, int other) {
  int* state = (int*) res[61];
  casadi_int i;
  for (i=0; i<count; ++i) {
    if (state[i]==old) state[i] = other;
  }
}
/* gather the contacts with those about to be added; without contacts that open faster than forces change
   speeds if one has an impact. The outcome */
static casadi_int casadi_join(const casadi_real** arg, casadi_real** res, casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[47];
  int* state = (int*) res[61];
  casadi_int i, impact = 0;
  casadi_real limits[2];
  casadi_gather(arg, res, iw);
  if (sizes[13]) return 0;
  sizes[13] = 1;
  casadi_changes(arg, res, iw);
  for (i=0; i<iw[0]; ++i) {
    if (res[24][i*iw[1]]<0 && casadi_strikes(arg, res, iw, i)) impact = 1;
  }
  if (!impact) return 0;
  casadi_largest(arg, res, iw, limits);
  for (i=0; i<sizes[9]; ++i) {
    if (state[i]!=3 || res[54][i*iw[1]]<=arg[37][19]*limits[0]) continue;
    state[i] = 1;
    --sizes[10];
  }
  if (sizes[10]==0) return 8;
  casadi_gather(arg, res, iw);
  return 0;
}
/* impulses of all contacts by Newton's law of impact; contacts that part do no work if positions are
   corrected. The number of proximal problems, or -1 if they did not converge */
static casadi_int casadi_newton_impulses(const casadi_real** arg, casadi_real** res,
    casadi_int* iw, casadi_real* w) {
  const casadi_real* before = res[24];
  const casadi_real* law;
  casadi_real limits[2];
  casadi_int i, a, r, width = iw[1], linear = iw[2]>0 ? ((const int*) arg[13])[1] : 1;
  casadi_largest(arg, res, iw, limits);
  for (i=0; i<iw[0]; ++i) {
    r = i*width;
    law = arg[28] + ((const int*) arg[33])[((const int*) res[23])[i]]*(2 + iw[2]);
    res[26][r] = law[0]*before[r];
    if (arg[36][13]>0 && before[r]>res[26][r]) res[26][r] = before[r];
    for (a=1; a<width; ++a) res[26][r+a] = a<linear ? law[1]*before[r+a] : 0.0;
  }
  casadi_begin_impulses(arg, res, iw, w);
  return casadi_impulses(arg, res, iw, w, limits[1]>0 ? limits[1] : 1.0);
}
/* distance by which the linear part of a stored gap closes in the step */
static casadi_real casadi_closing(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_int i) {
  const int* row = (const int*) res[52];
  const int* column = (const int*) res[53];
  casadi_int r = i*iw[1];
  casadi_real after = res[55][r] + casadi_row(res[51], column, row[r], row[r+1], res[62])
    - casadi_row(res[51], column, row[r], row[r+1], res[49]);
  return -arg[36][0]/2*(res[54][r] + after);
}
/* whether the shapes of a contact that closes may pass through each other */
static int casadi_closes(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int i) {
  casadi_real closing = casadi_closing(arg, res, iw, i);
  return closing>arg[36][2] && closing - res[56][i]>arg[36][2];
}
/* whether a contact at the end has the same shapes as a stored one, and the opposite normal */
static int casadi_reversed(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_int i) {
  const int* contact = (const int*) arg[51];
  casadi_int e;
  casadi_real normal[3];
  for (e=0; e<iw[0]; ++e, contact+=6) {
    if (contact[5]!=((const int*) res[58])[6*i+5]) continue;
    casadi_signed_normal(arg, iw, contact, normal);
    if (casadi_dot(normal, res[60] + 3*i)<0) return 1;
  }
  return 0;
}
/* stored contacts that are added: those that are closed at the end, and those at rest that a correction
   would open. Their number, or -1 if others are closed */
static casadi_int casadi_added(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const casadi_int* sizes = (const casadi_int*) arg[47];
  const casadi_int* keys = (const casadi_int*) arg[43];
  const casadi_int* stored = (const casadi_int*) res[57];
  int* state = (int*) res[61];
  casadi_int i, e, r, added = 0;
  casadi_real forced = res[11][5], h = arg[36][0];
  for (i=0; i<sizes[9]; ++i) {
    if (state[i]!=1) continue;
    r = i*iw[1];
    if (res[56][i]<=h*forced/2 && fabs(res[54][r])<=arg[37][19]*forced
        && -casadi_closing(arg, res, iw, i)<=arg[36][2]) state[i] = 3;
    for (e=0; e<iw[0] && state[i]==1; ++e) {
      if (keys[e]==stored[i] && arg[45][e]<-arg[36][2]) state[i] = 3;
    }
    if (state[i]==3) ++added;
  }
  for (e=0; e<iw[0] && added==0; ++e) {
    if (!(arg[45][e]<-arg[36][2])) continue;
    for (i=0; i<sizes[9] && !(stored[i]==keys[e] && state[i]==2); ++i) {}
    if (i==sizes[9]) added = -1;
  }
  return added;
}
/* gaps at the end of the step, where the shapes are: the smallest one in res[11][4], the contacts that are
   added, and whether shapes pass through each other; the outcome */
static casadi_int casadi_check_end(const casadi_real** arg, casadi_real** res, casadi_int* iw) {
  casadi_int* sizes = (casadi_int*) arg[47];
  casadi_int i, closes = 0;
  casadi_real reach[2];
  reach[0] = 0;
  reach[1] = 0;
  for (i=0; i<sizes[9]; ++i) {
    if (casadi_closes(arg, res, iw, i)) closes = 1;
  }
  if (closes) casadi_fastest(arg, iw, res[28], reach);
  for (i=0; i<2; ++i) {
    reach[i] = 2*reach[i];
    if (reach[i]>res[11][3]) res[11][3] = reach[i];
  }
  if (!casadi_listed(arg, iw, reach[0]>reach[1] ? reach[0] : reach[1])) return 2;
  res[11][4] = casadi_contacts(arg, res, iw, reach);
  if (iw[0]>iw[19]) return 7;
  sizes[10] = 0;
  sizes[11] = 0;
  sizes[13] = 0;
  casadi_exchange(res, sizes[9], 3, 2);
  for (i=0; i<sizes[9] && closes; ++i) {
    if (casadi_closes(arg, res, iw, i) && casadi_reversed(arg, res, iw, i)) sizes[11] = 1;
  }
  if (res[11][4]>=-arg[36][2]) return 0;
  if (sizes[12]) sizes[10] = casadi_added(arg, res, iw);
  return 4;
}
/* displacement along M^-1 that opens the gaps where the shapes are, with the entries of M in arg[64] and
   the inverses of its blocks in res[63] and res[64]; the outcome */
static casadi_int casadi_correct(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w) {
  const casadi_real* inputs[65];
  casadi_real* outputs[65];
  const int* contact;
  casadi_int i, k, r, a, width = iw[1], groups = iw[2];
  casadi_real reach[2], other[2], scale;
  for (i=0; i<65; ++i) {
    inputs[i] = arg[i];
    outputs[i] = res[i];
  }
  inputs[14] = arg[64];
  outputs[20] = res[63];
  outputs[21] = res[64];
  reach[0] = 0;
  reach[1] = 0;
  casadi_fastest(arg, iw, arg[22], reach);
  for (i=0; i<2; ++i) reach[i] = 2*arg[36][0]*reach[i];
  for (k=0; k<20; ++k) {
    res[11][3] = reach[0]>reach[1] ? reach[0] : reach[1];
    if (!casadi_listed(arg, iw, res[11][3])) return 2;
    res[11][4] = casadi_contacts(arg, res, iw, reach);
    if (iw[0]>iw[19]) return 7;
    if (res[11][4]>=-arg[36][2]) return 0;
    if (casadi_invert(inputs, outputs, iw, w)) return 1;
    scale = -res[11][4]>arg[36][14] ? -res[11][4] : arg[36][14];
    contact = (const int*) arg[51];
    for (i=0; i<iw[0]; ++i, contact+=6) {
      casadi_response_rows(inputs, outputs, iw, i, contact[1], contact[3]);
      for (a=0; a<groups; ++a) ((casadi_real*) arg[3])[i*groups+a] = 0;
      for (r=i*width; r<(i+1)*width; ++r) {
        ((casadi_real*) arg[2])[r] = r==i*width ? arg[45][i] : 0.0;
        res[0][r] = 0;
      }
    }
    if (casadi_contact_places(inputs, outputs, iw)) return 5;
    casadi_begin_impulses(inputs, outputs, iw, w);
    casadi_solution(inputs, outputs, iw, w, arg[36][1], scale);
    if (!(res[11][1]<=arg[36][1]*casadi_size(arg, iw, res[0], scale))) return 6;
    casadi_shorten(arg, res[0], iw);
    casadi_respond(arg[1], (const int*) arg[11], (const int*) arg[12], res[0], iw[0]*width, iw[3],
      res[28]);
    other[0] = 0;
    other[1] = 0;
    casadi_fastest(arg, iw, res[28], other);
    if (2*other[0]<=reach[0] && 2*other[1]<=reach[1]) return 4;
    for (i=0; i<2; ++i) reach[i] = 2*other[i]>reach[i] ? 2*other[i] : reach[i];
  }
  return 6;
}
/* a call; iw[6] is its outcome, of a step as of anticipated impacts; 4 a gap is closed at the end; 8 no
   contact is added. Calls are a step (0), the last step with other forces (3), with more contacts (4) or
   again without these (5), gaps at its end (6), and a correction (7) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w,
    int mem) {
  const casadi_int* sizes = (const casadi_int*) arg[47];
  const casadi_real* last;
  casadi_real deepest[1];
  casadi_int j, r, rounds = 0, call = sizes[6], joins = call==4 || call==5;
  if (call>=6) {
    iw[6] = call==6 ? casadi_check_end(arg, res, iw) : casadi_correct(arg, res, iw, w);
    return 0;
  }
  last = res[30] + 6*(joins ? iw[20] - 1 : iw[20]);
  iw[6] = 1;
  if (casadi_free_speeds(arg, res, iw, w)) return 0;
  iw[6] = 0;
  deepest[0] = last[0];
  if (call==3) casadi_other_forces(arg, res, iw);
  if (call==4) iw[6] = casadi_join(arg, res, iw);
  if (call==5) {
    casadi_exchange(res, sizes[9], 3, 1);
    casadi_gather(arg, res, iw);
  }
  if (call==0) {
    iw[6] = casadi_prepare(arg, res, iw, 1.5, deepest);
    if (iw[6]) return 0;
    if (iw[21]+iw[0]>iw[22]) iw[6] = 3;
    casadi_store(arg, res, iw);
    casadi_gather(arg, res, iw);
  }
  if (iw[6]) return 0;
  iw[6] = 5;
  if (call!=3 && casadi_contact_places(arg, res, iw)) return 0;
  iw[6] = 6;
  for (j=0; j<iw[3]; ++j) res[10][j] = 0;
  if (iw[0]>0) rounds = casadi_newton_impulses(arg, res, iw, w);
  if (rounds<0) return 0;
  res[11][6] = 0;
  res[11][7] = 0;
  for (r=0; r<iw[0]*iw[1]; ++r) {
    res[11][6] += res[0][r]*(res[5][r] - res[48][r]);
    res[11][7] += fabs(res[0][r]);
  }
  if (joins) {
    iw[21] -= last[5];
    --iw[20];
  }
  if (casadi_finish(arg, res, iw, deepest[0], rounds)) return 0;
  for (j=0; j<iw[3]; ++j) res[62][j] = res[19][j];
  iw[6] = 0;
  return 0;
}
