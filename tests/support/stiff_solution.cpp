// SPDX-License-Identifier: MIT
#include "support/stiff_solution.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <stdexcept>

namespace spume::test {
namespace {

int call(realtype /*t*/, N_Vector state, N_Vector change, void* derivative) {
  (*static_cast<const Derivative*>(derivative))(N_VGetArrayPointer(state), N_VGetArrayPointer(change));
  return 0;
}

}  // namespace

void integrate_stiff(const Derivative& derivative, std::vector<double>& state, double duration) {
  constexpr double tolerance = 1e-11;
  constexpr long most_steps = 1'000'000;
  const auto size = static_cast<sunindextype>(state.size());
  SUNContext context = nullptr;
  SUNContext_Create(nullptr, &context);
  N_Vector values = N_VMake_Serial(size, state.data(), context);
  SUNMatrix matrix = SUNDenseMatrix(size, size, context);
  SUNLinearSolver solver = SUNLinSol_Dense(values, matrix, context);
  void* memory = CVodeCreate(CV_BDF, context);
  Derivative copy = derivative;
  double t = 0;
  const bool done =
      CVodeInit(memory, call, 0, values) == CV_SUCCESS &&
      CVodeSStolerances(memory, tolerance, tolerance) == CV_SUCCESS && CVodeSetUserData(memory, &copy) == CV_SUCCESS &&
      CVodeSetLinearSolver(memory, solver, matrix) == CV_SUCCESS &&
      CVodeSetMaxNumSteps(memory, most_steps) == CV_SUCCESS && CVodeSetStopTime(memory, duration) == CV_SUCCESS &&
      CVode(memory, duration, values, &t, CV_NORMAL) >= 0;
  CVodeFree(&memory);
  SUNLinSolFree(solver);
  SUNMatDestroy(matrix);
  N_VDestroy(values);
  SUNContext_Free(&context);
  if (!done) throw std::runtime_error("CVODE does not solve the equations");
}

}  // namespace spume::test
