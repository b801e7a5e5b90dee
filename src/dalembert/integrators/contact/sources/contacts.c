/* Functions of loops over contacts */
#include <math.h>
#define casadi_real double
#define casadi_int long long int
#ifdef _WIN32
#define CASADI_SYMBOL_EXPORT __declspec(dllexport)
#else
#define CASADI_SYMBOL_EXPORT
#endif
/* sum of products of a row with the speeds in its columns, in three sums that do not wait for each other */
static casadi_real casadi_row(const casadi_real* value, const int* column, casadi_int begin,
    casadi_int end, const casadi_real* speed) {
  casadi_int j;
  casadi_real sum = 0, second = 0, third = 0;
  for (j=begin; j+2<end; j+=3) {
    sum += value[j]*speed[column[j]];
    second += value[j+1]*speed[column[j+1]];
    third += value[j+2]*speed[column[j+2]];
  }
  for (; j<end; ++j) sum += value[j]*speed[column[j]];
  return sum + second + third;
}
