// SPDX-License-Identifier: MIT
// FFTW in both precisions under one name.
#pragma once

#include <fftw3.h>

#include <complex>
#include <mutex>

namespace spume::fftw {

// The planner of FFTW keeps global state: making and destroying plans, and wisdom, are serialised.
std::mutex& planner_mutex();

template <class T>
struct Api;

template <>
struct Api<double> {
  using Plan = fftw_plan;
  using Complex = fftw_complex;
  static constexpr auto many = fftw_plan_many_dft;
  static constexpr auto many_c2r = fftw_plan_many_dft_c2r;
  static constexpr auto many_r2c = fftw_plan_many_dft_r2c;
  static constexpr auto execute = fftw_execute_dft;
  static constexpr auto execute_c2r = fftw_execute_dft_c2r;
  static constexpr auto execute_r2c = fftw_execute_dft_r2c;
  static constexpr auto destroy = fftw_destroy_plan;
  static constexpr auto import_wisdom = fftw_import_wisdom_from_filename;
  static constexpr auto export_wisdom = fftw_export_wisdom_to_filename;
  static constexpr const char* name = "double";
  // Transforms of this program run inside its own parallel loops; RealTransform's plans have threads of their own.
  static void plan_for_one_thread() { fftw_plan_with_nthreads(1); }
};

template <>
struct Api<float> {
  using Plan = fftwf_plan;
  using Complex = fftwf_complex;
  static constexpr auto many = fftwf_plan_many_dft;
  static constexpr auto many_c2r = fftwf_plan_many_dft_c2r;
  static constexpr auto many_r2c = fftwf_plan_many_dft_r2c;
  static constexpr auto execute = fftwf_execute_dft;
  static constexpr auto execute_c2r = fftwf_execute_dft_c2r;
  static constexpr auto execute_r2c = fftwf_execute_dft_r2c;
  static constexpr auto destroy = fftwf_destroy_plan;
  static constexpr auto import_wisdom = fftwf_import_wisdom_from_filename;
  static constexpr auto export_wisdom = fftwf_export_wisdom_to_filename;
  static constexpr const char* name = "single";
  static void plan_for_one_thread() {}
};

template <class T>
typename Api<T>::Complex* pointer(std::complex<T>* values) {
  return reinterpret_cast<typename Api<T>::Complex*>(values);
}

}  // namespace spume::fftw
