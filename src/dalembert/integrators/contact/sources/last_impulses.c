/* Impulses of the step before, by the keys of contacts */
/* place of a key in a table; that of the first free entry, -1, if it is absent */
static casadi_int casadi_slot(const int* table, casadi_int size, const casadi_int* keys,
    casadi_int key) {
  casadi_int slot = key % size;
  while (table[slot]>=0 && keys[table[slot]]!=key) {
    ++slot;
    if (slot==size) slot = 0;
  }
  return slot;
}
/* table of the keys */
static void casadi_index(int* table, casadi_int size, const casadi_int* keys, casadi_int count) {
  casadi_int k;
  for (k=0; k<size; ++k) table[k] = -1;
  for (k=0; k<count; ++k) table[casadi_slot(table, size, keys, keys[k])] = k;
}
