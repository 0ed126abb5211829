// SPDX-License-Identifier: MIT
#include "spume/particles/direct_pressure.hpp"

#include <umfpack.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "spume/core/error.hpp"
#include "spume/operators/wall_stencils.hpp"
#include "spume/particles/options.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/draft.hpp"

namespace spume {
namespace {

// Of the least and the largest pivot: 7e-6 of 30,000 particles in 2-D, 5e-4 in 3-D, of densities 2:1.
constexpr double least_reciprocal_condition = 1e-13;

// A factorisation takes 2.2 s there in 2-D and 3.7 s in 3-D with the reference BLAS, and 130 and 120 MB.
constexpr std::size_t most_particles_2d = 50000, most_particles_3d = 10000;

}  // namespace

std::size_t most_particles_of_direct_solver(int dimensions) {
  return dimensions == 3 ? most_particles_3d : most_particles_2d;
}

struct DirectPressure::Factors {
  void* numeric = nullptr;
  Factors() = default;
  Factors(const Factors&) = delete;
  Factors& operator=(const Factors&) = delete;
  ~Factors() { release(); }
  void release() {
    if (numeric != nullptr) umfpack_di_free_numeric(&numeric);
    bytes = 0;
  }
  double bytes = 0;
};

DirectPressure::DirectPressure() : factors_(std::make_unique<Factors>()) {}
DirectPressure::~DirectPressure() = default;

void DirectPressure::factorise(ProjectionMatrix& matrix, std::span<const float> diagonal, bool singular,
                               const PartConstants& enclosed) {
  const SweepContext* context = matrix.context();
  if (context == nullptr) throw std::logic_error("the direct solver needs a matrix of pairs of particles");
  size_ = matrix.size();
  if (size_ == 0) return;
  borders_ = enclosed.parts();
  if (singular && (borders_.empty() || enclosed.rest())) {
    std::vector<char> of_part(size_, 0);
    for (const auto& part : borders_)
      for (const std::int32_t i : part) of_part[static_cast<std::size_t>(i)] = 1;
    std::vector<std::int32_t> rest;
    for (std::size_t i = 0; i < size_; ++i)
      if (of_part[i] == 0 && diagonal[i] != 0) rest.push_back(static_cast<std::int32_t>(i));
    if (!rest.empty()) borders_.push_back(std::move(rest));
  }
  find_pattern(*context, matrix.tied(), diagonal);
  find_colours();
  find_entries(matrix);
  factorise_entries();
}

// Rows of fixed particles hold themselves alone, and so do their columns: nothing is added to what they have.
void DirectPressure::find_pattern(const SweepContext& context, const TiedRows* tied, std::span<const float> diagonal) {
  const auto n = static_cast<std::int32_t>(size_);
  const std::int32_t* source = context.images == nullptr ? nullptr : context.images->source();
  const std::int32_t* point = context.walls == nullptr ? nullptr : context.images->wall_point();
  const auto fixed = [&](std::int32_t i) { return diagonal[static_cast<std::size_t>(i)] == 0; };
  row_first_.assign(1, 0);
  column_.clear();
  std::vector<std::int32_t> met;
  for (std::int32_t i = 0; i < n; ++i) {
    met.assign(1, i);
    const auto meet_particle = [&](std::int32_t j) {
      if (!fixed(j)) met.push_back(j);
    };
    const auto meet_sources = [&](const WallStencils& stencils, std::size_t g, auto&& meet_source) {
      for (std::int64_t e = stencils.first[g]; e < stencils.first[g + 1]; ++e)
        meet_source(stencils.source[static_cast<std::size_t>(e)]);
    };
    const auto meet = [&](std::int32_t j) {
      const std::int32_t g = tied == nullptr ? -1 : tied->point[static_cast<std::size_t>(j)];
      if (g < 0)
        meet_particle(j);
      else
        meet_sources(*tied->stencils, static_cast<std::size_t>(g), meet_particle);
    };
    if (!fixed(i))
      for (const std::int32_t p : context.list->of(static_cast<std::size_t>(i))) {
        if (p < n) {
          meet(p);
        } else if (const std::int32_t k = p - n; point == nullptr || point[k] < 0) {
          meet(source[k]);
        } else {
          meet_sources(*context.walls, static_cast<std::size_t>(point[k]), meet);
        }
      }
    std::sort(met.begin(), met.end());
    met.erase(std::unique(met.begin(), met.end()), met.end());
    column_.insert(column_.end(), met.begin(), met.end());
    row_first_.push_back(static_cast<int>(column_.size()));
  }
  // By columns, rows in order; borders last.
  const std::size_t columns = size_ + borders_.size();
  first_.assign(columns + 1, 0);
  const double border = *std::max_element(diagonal.begin(), diagonal.end());
  for (const int j : column_) ++first_[static_cast<std::size_t>(j) + 1];
  for (std::size_t b = 0; b < borders_.size(); ++b) {
    for (const std::int32_t j : borders_[b]) ++first_[static_cast<std::size_t>(j) + 1];
    first_[size_ + b + 1] = static_cast<int>(borders_[b].size());
  }
  for (std::size_t j = 0; j < columns; ++j) first_[j + 1] += first_[j];
  row_.resize(static_cast<std::size_t>(first_[columns]));
  entry_.assign(row_.size(), 0.0);
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int i = 0; i < n; ++i)
    for (int k = row_first_[static_cast<std::size_t>(i)]; k < row_first_[static_cast<std::size_t>(i) + 1]; ++k)
      row_[static_cast<std::size_t>(next[static_cast<std::size_t>(column_[static_cast<std::size_t>(k)])]++)] = i;
  for (std::size_t b = 0; b < borders_.size(); ++b)
    for (const std::int32_t j : borders_[b]) {
      const auto below = static_cast<std::size_t>(next[static_cast<std::size_t>(j)]++);
      row_[below] = static_cast<int>(size_ + b);
      entry_[below] = border;
      const auto beside = static_cast<std::size_t>(next[size_ + b]++);
      row_[beside] = j;
      entry_[beside] = border;
    }
  // Fixed ones have no colour, and 1 on the diagonal.
  colour_.assign(size_, 0);
  for (std::int32_t i = 0; i < n; ++i)
    if (fixed(i)) {
      colour_[static_cast<std::size_t>(i)] = -1;
      entry_[static_cast<std::size_t>(first_[static_cast<std::size_t>(i)])] = 1;
    }
}

// Each column takes the first colour that no column has which shares a row with it.
void DirectPressure::find_colours() {
  std::vector<int> taken;  // by which column a colour was last seen
  colours_ = 0;
  std::vector<char> done(size_, 0);
  for (std::size_t j = 0; j < size_; ++j) {
    if (colour_[j] < 0) continue;
    for (int k = first_[j]; k < first_[j + 1]; ++k) {
      const auto i = static_cast<std::size_t>(row_[static_cast<std::size_t>(k)]);
      if (i >= size_) continue;
      for (int e = row_first_[i]; e < row_first_[i + 1]; ++e) {
        const auto other = static_cast<std::size_t>(column_[static_cast<std::size_t>(e)]);
        if (done[other] != 0) taken[static_cast<std::size_t>(colour_[other])] = static_cast<int>(j);
      }
    }
    int colour = 0;
    while (colour < colours_ && taken[static_cast<std::size_t>(colour)] == static_cast<int>(j)) ++colour;
    if (colour == colours_) {
      ++colours_;
      taken.push_back(-1);
    }
    colour_[j] = colour;
    done[j] = 1;
  }
}

void DirectPressure::find_entries(ProjectionMatrix& matrix) {
  std::vector<double> x(size_), zero(size_), product(size_);
  for (int colour = 0; colour < colours_; ++colour) {
    for (std::size_t j = 0; j < size_; ++j) x[j] = colour_[j] == colour ? 1 : 0;
    matrix.residual(x, zero, product, false);  // -A x
    for (std::size_t j = 0; j < size_; ++j) {
      if (colour_[j] != colour) continue;
      for (int k = first_[j]; k < first_[j + 1]; ++k)
        if (const auto i = static_cast<std::size_t>(row_[static_cast<std::size_t>(k)]); i < size_)
          entry_[static_cast<std::size_t>(k)] = -product[i];
    }
  }
}

// Which particles meet is mutual but for fits at walls. Nested dissection leaves 0.75 of the factors of minimum degree
// in 3-D and half of its operations; the unsymmetric strategy fails at 10,000 particles in 2-D.
void DirectPressure::factorise_entries() {
  factors_->release();
  const int size = static_cast<int>(first_.size()) - 1;
  std::array<double, UMFPACK_CONTROL> control{};
  std::array<double, UMFPACK_INFO> info{};
  umfpack_di_defaults(control.data());
  control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
  control[UMFPACK_ORDERING] = UMFPACK_ORDERING_METIS;
  void* symbolic = nullptr;
  int status = umfpack_di_symbolic(size, size, first_.data(), row_.data(), entry_.data(), &symbolic, control.data(),
                                   info.data());
  if (status == UMFPACK_OK)
    status = umfpack_di_numeric(first_.data(), row_.data(), entry_.data(), symbolic, &factors_->numeric, control.data(),
                                info.data());
  umfpack_di_free_symbolic(&symbolic);
  factors_->bytes = info[UMFPACK_NUMERIC_SIZE] * info[UMFPACK_SIZE_OF_UNIT];
  peak_bytes_ = info[UMFPACK_PEAK_MEMORY] * info[UMFPACK_SIZE_OF_UNIT];
  reciprocal_condition_ = info[UMFPACK_RCOND];
  if (status == UMFPACK_OK && reciprocal_condition_ >= least_reciprocal_condition) return;
  StepFailure::Details details;
  details.cause = status == UMFPACK_ERROR_out_of_memory
                      ? "the direct solver has no memory for its factors"
                      : "the matrix of the pressure is singular: liquid that is enclosed apart from the rest";
  details.option = "pressure.solver";
  throw StepFailure(details);
}

void DirectPressure::solve(std::span<const double> r, std::span<double> x) {
  if (size_ == 0 && r.empty()) return;
  if (factors_->numeric == nullptr || r.size() != size_)
    throw std::logic_error("the direct solver has no factors of this matrix");
  const std::size_t columns = first_.size() - 1;
  right_.assign(columns, 0.0);
  solution_.resize(columns);
  std::copy(r.begin(), r.end(), right_.begin());
  umfpack_di_solve(UMFPACK_A, first_.data(), row_.data(), entry_.data(), solution_.data(), right_.data(),
                   factors_->numeric, nullptr, nullptr);
  std::copy_n(solution_.begin(), size_, x.begin());
}

double DirectPressure::bytes() const {
  double sum = peak_bytes_;
  for (const auto* v : {&first_, &row_, &row_first_, &column_, &colour_})
    sum += 4.0 * static_cast<double>(v->capacity());
  for (const auto* v : {&entry_, &right_, &solution_}) sum += 8.0 * static_cast<double>(v->capacity());
  return sum;
}

double DirectPressure::factor_bytes() const {
  return factors_->bytes;
}

void check_direct_solver(const Draft& draft, const Scene& scene, Problems& problems) {
  const Node* node = draft.node("pressure.solver");
  if (node == nullptr || draft.options.get<PressureOptions>().solver != PressureSolver::direct) return;
  const std::size_t limit = most_particles_of_direct_solver(scene.domain.dimensions);
  if (scene.particles.size() > limit)
    problems.add(*node, "pressure.solver = \"direct\" factorises the matrix of " +
                            std::to_string(scene.particles.size()) +
                            " particles, which takes seconds in each step; it is for at most " + std::to_string(limit) +
                            ": use \"bicgstab\", or a larger resolution.spacing");
  if (std::any_of(scene.motions.begin(), scene.motions.end(), [](const BodyMotion& motion) { return motion.floats; }))
    problems.add(*node,
                 "pressure.solver = \"direct\" does not go with bodies that float, which couple all particles "
                 "around them; use \"bicgstab\"");
}

}  // namespace spume
