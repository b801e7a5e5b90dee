/* Functions of loops over contacts */
#include <math.h>
#define casadi_real double
#define casadi_int long long int
#ifdef _WIN32
#define CASADI_SYMBOL_EXPORT __declspec(dllexport)
#else
#define CASADI_SYMBOL_EXPORT
#endif
static casadi_real casadi_row(const casadi_real* value, const int* column, casadi_int begin,
    casadi_int end, const casadi_real* speed) {
  casadi_int j;
  casadi_real sum = 0;
  for (j=begin; j<end; ++j) sum += value[j]*speed[column[j]];
  return sum;
}
