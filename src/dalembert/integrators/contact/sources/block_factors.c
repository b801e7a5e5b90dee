/* Factors L U of a sparse matrix of square blocks with a symmetric pattern, without pivots between
   blocks: first the blocks of the diagonal, then those below it by columns, then those to the right
   of it by rows, all in the order of elimination */
/* number of block (i, j); -1 outside of the pattern */
static casadi_int casadi_block(const int* first, const int* row, casadi_int blocks, casadi_int i,
    casadi_int j) {
  casadi_int k, pivot = i<j ? i : j, other = i<j ? j : i;
  if (i==j) return i;
  for (k=first[pivot]; k<first[pivot+1]; ++k) {
    if (row[k]==other) return i>j ? blocks + k : blocks + first[blocks] + k;
  }
  return -1;
}
/* target = target - a b for blocks */
static void casadi_subtract(casadi_real* target, const casadi_real* a, const casadi_real* b,
    casadi_int size) {
  casadi_int i, j, k;
  casadi_real x, y, z, line[6];
  if (size==3) {
    for (i=0; i<3; ++i) {
      x = a[3*i];
      y = a[3*i+1];
      z = a[3*i+2];
      target[3*i] -= x*b[0] + y*b[3] + z*b[6];
      target[3*i+1] -= x*b[1] + y*b[4] + z*b[7];
      target[3*i+2] -= x*b[2] + y*b[5] + z*b[8];
    }
    return;
  }
  if (size==6) {
    for (i=0; i<6; ++i) {
      for (j=0; j<6; ++j) line[j] = target[6*i+j];
      for (k=0; k<6; ++k) {
        x = a[6*i+k];
        for (j=0; j<6; ++j) line[j] -= x*b[6*k+j];
      }
      for (j=0; j<6; ++j) target[6*i+j] = line[j];
    }
    return;
  }
  for (i=0; i<size; ++i) {
    for (k=0; k<size; ++k) {
      x = a[i*size+k];
      for (j=0; j<size; ++j) target[i*size+j] -= x*b[k*size+j];
    }
  }
}
/* inverses of pivots on the diagonal, L without them below; 1 if a pivot is singular. used[k] is 1
   for blocks below the diagonal that are not zero, or whose counterparts to the right are not */
static int casadi_factorise(casadi_real* matrix, const int* first, const int* row,
    casadi_int blocks, casadi_int size, casadi_real* used, casadi_real* w) {
  casadi_int k, q, r, p, i, j, square = size*size, below = first[blocks];
  casadi_real* lower = matrix + blocks*square;
  casadi_real* upper = lower + below*square;
  for (q=0; q<below; ++q) {
    used[q] = 0;
    for (i=0; i<square; ++i) {
      if (lower[q*square+i]!=0 || upper[q*square+i]!=0) used[q] = 1;
    }
  }
  for (k=0; k<blocks; ++k) {
    for (i=0; i<square; ++i) {
      w[i] = matrix[k*square+i];
      matrix[k*square+i] = 0;
    }
    for (i=0; i<size; ++i) matrix[k*square+i*size+i] = 1;
    if (!casadi_eliminate(w, matrix + k*square, size, size)) return 1;
    for (q=first[k]; q<first[k+1]; ++q) {
      if (used[q]==0) continue;
      for (i=0; i<square; ++i) {
        w[i] = -lower[q*square+i];
        lower[q*square+i] = 0;
      }
      casadi_subtract(lower + q*square, w, matrix + k*square, size);
    }
    for (q=first[k]; q<first[k+1]; ++q) {
      if (used[q]==0) continue;
      j = row[q];
      casadi_subtract(matrix + j*square, lower + q*square, upper + q*square, size);
      p = first[j];
      for (r=q+1; r<first[k+1]; ++r) {
        if (used[r]==0) continue;
        while (row[p]!=row[r]) ++p;
        casadi_subtract(lower + p*square, lower + r*square, upper + q*square, size);
        casadi_subtract(upper + p*square, lower + q*square, upper + r*square, size);
        used[p] = 1;
      }
    }
  }
  return 0;
}
/* solution for a right-hand side; members are the places of the entries of each block in both, -1
   for padding */
static void casadi_solve(const casadi_real* matrix, const int* first, const int* row,
    const int* members, casadi_int blocks, casadi_int size, const casadi_real* used,
    const casadi_real* right, casadi_real* solution, casadi_real* w) {
  casadi_int k, q, i, j, square = size*size;
  const casadi_real* lower = matrix + blocks*square;
  const casadi_real* upper = lower + first[blocks]*square;
  casadi_real* x = w;
  casadi_real* y = w + blocks*size;
  for (k=0; k<blocks*size; ++k) x[k] = members[k]<0 ? 0.0 : right[members[k]];
  for (k=0; k<blocks; ++k) {
    for (q=first[k]; q<first[k+1]; ++q) {
      if (used[q]==0) continue;
      for (i=0; i<size; ++i) {
        for (j=0; j<size; ++j) x[row[q]*size+i] -= lower[q*square+i*size+j]*x[k*size+j];
      }
    }
  }
  for (k=blocks-1; k>=0; --k) {
    for (i=0; i<size; ++i) y[i] = x[k*size+i];
    for (q=first[k]; q<first[k+1]; ++q) {
      if (used[q]==0) continue;
      for (i=0; i<size; ++i) {
        for (j=0; j<size; ++j) y[i] -= upper[q*square+i*size+j]*x[row[q]*size+j];
      }
    }
    for (i=0; i<size; ++i) {
      x[k*size+i] = 0;
      for (j=0; j<size; ++j) x[k*size+i] += matrix[k*square+i*size+j]*y[j];
    }
  }
  for (k=0; k<blocks*size; ++k) {
    if (members[k]>=0) solution[members[k]] = x[k];
  }
}
/* places of the entries of all contacts in the blocks, those of successive contacts between the same
   bodies once; 1 outside of the blocks */
static int casadi_contact_places(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw) {
  const int* w_row = (const int*) arg[DIRECTION_ROWS];
  const int* w_column = (const int*) arg[DIRECTION_COLUMNS];
  const int* owner = (const int*) arg[BLOCK_OF_SPEED];
  const int* position = (const int*) arg[PLACE_IN_BLOCK];
  const int* first = (const int*) arg[FACTOR_STARTS];
  const int* row = (const int*) arg[FACTOR_ROWS];
  int* start = (int*) res[COLUMN_STARTS];
  int* column = (int*) res[COLUMNS];
  int* local = (int*) res[LOCAL_COLUMNS];
  int* block = (int*) res[ENTRY_STARTS];
  int* place = (int*) res[ENTRIES];
  casadi_int count = iw[CONTACTS], width = iw[COMPONENTS], size = iw[BLOCK_SIZE], i, j, k, b, c, own,
    next = 0;
  casadi_int last_row, last_column, same, number = 0;
  start[0] = 0;
  for (i=0; i<count; ++i) {
    own = 0;
    for (j=w_row[i*width]; j<w_row[(i+1)*width]; ++j) {
      for (k=0; k<own && column[start[i]+k]!=w_column[j]; ++k) {}
      local[j] = k;
      if (k==own) {
        column[start[i]+own] = w_column[j];
        ++own;
      }
    }
    start[i+1] = start[i] + own;
    same = i>0 && start[i] - start[i-1]==own;
    for (k=0; k<own && same; ++k) same = column[start[i]+k]==column[start[i-1]+k];
    block[i] = same ? block[i-1] : next;
    if (same) continue;
    last_row = -1;
    last_column = -1;
    for (b=0; b<own; ++b) {
      k = column[start[i]+b];
      for (c=0; c<own; ++c) {
        j = column[start[i]+c];
        if (owner[j]!=last_row || owner[k]!=last_column) {
          last_row = owner[j];
          last_column = owner[k];
          number = casadi_block(first, row, iw[BLOCKS], last_row, last_column);
          if (number<0) return 1;
        }
        place[next] = number*size*size + position[j]*size + position[k];
        ++next;
      }
    }
  }
  return 0;
}
/* the matrix without contacts: inertia, and ones for padding; 1 outside of the blocks */
static int casadi_inertia_blocks(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw) {
  const casadi_real* inertia = arg[INERTIA];
  const int* a_row = (const int*) arg[INERTIA_ROWS];
  const int* a_column = (const int*) arg[INERTIA_COLUMNS];
  const int* owner = (const int*) arg[BLOCK_OF_SPEED];
  const int* position = (const int*) arg[PLACE_IN_BLOCK];
  const int* members = (const int*) arg[BLOCK_MEMBERS];
  casadi_real* constant = res[CONSTANT];
  casadi_int blocks = iw[BLOCKS], size = iw[BLOCK_SIZE], i, j, k;
  for (j=0; j<iw[ENTRIES]; ++j) constant[j] = 0;
  for (k=0; k<blocks*size; ++k) {
    if (members[k]<0) constant[k/size*size*size + k%size*(size+1)] = 1;
  }
  for (k=0; k<iw[SPEEDS]; ++k) {
    for (j=a_row[k]; j<a_row[k+1]; ++j) {
      i = casadi_block((const int*) arg[FACTOR_STARTS], (const int*) arg[FACTOR_ROWS], blocks, owner[k],
        owner[a_column[j]]);
      if (i<0) return 1;
      constant[i*size*size + position[k]*size + position[a_column[j]]] = inertia[j];
    }
  }
  return 0;
}
