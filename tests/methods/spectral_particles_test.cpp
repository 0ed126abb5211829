// SPDX-License-Identifier: MIT
// Particles in the flow of the spectral method.
#include <gmock/gmock.h>
#include <omp.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "methods/spectral_flow.hpp"
#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/spectral/particle_options.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using test::random_start;
using test::SavedState;
using test::spectral_text;
using test::SpectralRun;
using testing::IsSupersetOf;

const std::string bubbles =
    "[particles]\ncount = 2000\ndiameter = 0.03\nbeta = 3\nresponse_time = 0.05\noverlap_samples = 500\nsort_every = "
    "3\n";

std::string suspension(const std::string& coupling) {
  return spectral_text("[12, 16, 20]", random_start + bubbles + "coupling = \"" + coupling + "\"\n");
}

TEST(SpectralParticles, LeaveTheFlowAloneWithOneWayCoupling) {
  SpectralRun<> with(suspension("one-way")), without(spectral_text("[12, 16, 20]", random_start));
  with.start().steps(5, 0.002);
  without.start().steps(5, 0.002);
  const SavedState a = with.saved(), b = without.saved();
  EXPECT_EQ(a.reals.at("potential_x"), b.reals.at("potential_x"));
  EXPECT_EQ(a.reals.at("potential_z"), b.reals.at("potential_z"));
}

TEST(SpectralParticles, CostNothingWhereThereAreNone) {
  SpectralRun<> run(spectral_text("[12, 16, 20]", random_start));
  run.start().steps(2, 0.002);
  EXPECT_EQ(run.method.suspension(), nullptr);
  EXPECT_TRUE(run.method.snapshot().empty());
  for (const auto& stage : run.method.plan()) EXPECT_EQ(stage.name.find("particle"), std::string::npos);
  for (const auto& array : run.method.arrays()) EXPECT_EQ(array.name.find("particle"), std::string::npos);
}

TEST(SpectralParticles, ReportWhatTheirCouplingHas) {
  SpectralRun<> run(suspension("four-way"));
  run.start().steps(3, 0.002);
  std::vector<std::string> names;
  for (const auto& [name, value] : run.series()) {
    names.push_back(name);
    EXPECT_TRUE(std::isfinite(value) || name == "correlation_dimension") << name;
  }
  EXPECT_THAT(names, IsSupersetOf({"particle_rms_velocity", "overlap_ratio", "particle_work", "collisions"}));
  const auto families = run.method.snapshot();
  ASSERT_EQ(families.size(), 1U);
  EXPECT_EQ(families[0].name, "bubbles");
  EXPECT_EQ(families[0].size, 2000U);
  std::vector<double> boxes;
  run.method.table_rows("particle_boxes", boxes);
  // Sides of 1/12, 1/6 and 1/3 in a box of 1 x 1.5 x 2; 2000 particles lie in all boxes together.
  ASSERT_EQ(boxes.size(), 12U);
  EXPECT_NEAR(boxes[2] * 12 * 18 * 24, 2000, 1e-9);
  std::vector<std::string> tables;
  for (const RecordTable& table : run.method.tables()) {
    tables.push_back(table.name);
    std::vector<double> rows;
    run.method.table_rows(table.name, rows);
    EXPECT_GT(rows.size(), 0U) << table.name;
    EXPECT_EQ(rows.size() % table.columns.size(), 0U) << table.name;
    EXPECT_EQ(rows[0], run.method.time()) << table.name;
  }
  EXPECT_THAT(tables, testing::ElementsAre("spectrum", "gradient_pdf", "particle_pairs", "particle_boxes",
                                           "particle_overlaps"));
}

TEST(SpectralParticles, StayWithinTheMemoryThatTheyAreRefusedBy) {
  for (const std::string coupling : {"one-way", "two-way"})
    for (const std::string precision : {"double", "single"}) {
      const LoadedCase loaded =
          test::load_text(spectral_text("48", random_start + bubbles + "coupling = \"" + coupling +
                                                  "\"\n[spectral]\nprecision = \"" + precision + "\"\n"));
      const double counted = spectral::suspension_bytes(loaded, spectral::particle_options(loaded));
      const auto particles = [&](auto method) {
        method.start();
        Ledger ledger;
        for (int step = 0; step < 3; ++step) method.step(0.001, ledger);
        double bytes = 0, flow = 0;
        for (const auto& array : method.arrays()) bytes += array.bytes;
        for (const auto& array : method.flow().arrays()) flow += array.bytes;
        return bytes - flow;
      };
      const double held = precision == "double" ? particles(spectral::Spectral<double>(loaded))
                                                : particles(spectral::Spectral<float>(loaded));
      // Beside the planes of a thread: 33 rows of 52 points by four numbers, twice.
      const double planes = 2 * 8.0 * 4 * 52 * 33 * omp_get_max_threads();
      EXPECT_NEAR(held, counted, 0.05 * counted + (coupling == "two-way" ? planes : 0.0)) << coupling << precision;
    }
}

TEST(SpectralParticles, ContinueBitForBitFromACheckpoint) {
  for (const std::string more : {"", "lyapunov = 5\nrecords = \"double\"\n"}) {
    SpectralRun<> whole(suspension("four-way") + more), first(suspension("four-way") + more),
        second(suspension("four-way") + more);
    whole.start().steps(8, 0.002);
    first.start().steps(3, 0.002);
    SavedState state = first.saved();
    second.method.load(state);
    second.steps(5, 0.002);
    const SavedState a = whole.saved(), b = second.saved();
    EXPECT_EQ(a.reals, b.reals);
    EXPECT_EQ(a.integers, b.integers);
  }
}

// The file of the places is read at the start alone: a run goes on without it.
TEST(SpectralParticles, FromAFileGoOnWithoutIt) {
  const test::TemporaryFolder folder;
  const auto file = folder / "places.csv";
  std::ofstream(file) << "x, y, z\n0.1, 0.2, 0.3\n0.4, 0.5, 0.6\n0.9, 0.8, 0.7\n";
  const std::string text = spectral_text("[12, 16, 20]", random_start +
                                                             "[particles]\ncount = 3\ndiameter = 0.03\nbeta = 3\n"
                                                             "response_time = 0.05\nplacement = \"file\"\nfile = \"" +
                                                             file.string() + "\"\n");
  SpectralRun<> whole(text), first(text);
  whole.start().steps(4, 0.002);
  SavedState state = first.start().steps(2, 0.002).saved();
  std::filesystem::remove(file);
  EXPECT_THROW(SpectralRun<>{text}, InputError);
  LoadedCase loaded = test::load_text(text);
  loaded.resuming = true;
  spectral::Spectral<double> method(loaded);
  method.load(state);
  Ledger ledger;
  for (int step = 0; step < 2; ++step) method.step(0.002, ledger);
  SavedState ended;
  method.save(ended);
  EXPECT_EQ(ended.reals, whole.saved().reals);
}

TEST(SpectralParticles, AreTheSameForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<SavedState> states;
  for (const int threads : {1, 3}) {
    omp_set_num_threads(threads);
    SpectralRun<> run(suspension("four-way"));
    run.start().steps(4, 0.002);
    states.push_back(run.saved());
  }
  omp_set_num_threads(before);
  for (const char* name : {"particle_position_x", "particle_velocity_z", "particle_amounts"})
    EXPECT_EQ(states[0].reals.at(name), states[1].reals.at(name)) << name;
}

// Bubbles at every grid point with volume fraction a turn the decay exp(-nu k^2 t) of a Beltrami flow into
// exp(-nu k^2 t / (1 - a)): (11) of the paper, exactly, as u . grad u is a gradient.
double coupled_decay_error(const std::string& integrator, double dt) {
  SpectralRun<> run(
      "method = \"spectral\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\nx = \"periodic\"\ny = \"periodic\"\n"
      "z = \"periodic\"\n[resolution]\ngrid = 12\n[time]\nend = 1\ncourant = 1\n[fluid]\nreynolds = 4\n[initial]\nkind "
      "= \"abc\"\n"
      "[spectral]\nintegrator = \"" +
      integrator +
      "\"\n[particles]\ncount = 1728\ndiameter = 0.0601117\nbeta = 3\nresponse_time = 1\nplacement = \"lattice\"\n"
      "frozen = true\ncoupling = \"two-way\"\nremove_self_disturbance = false\nspline_order = 6\nrecords = "
      "\"double\"\noverlap_samples = 0\n");
  const double fraction = 1728 * M_PI / 6 * std::pow(0.0601117, 3);
  const int steps = static_cast<int>(std::lround(0.04 / dt));
  // No force is known in the first step; the rate is taken after it.
  run.start().steps(steps, dt);
  const double early = run.method.flow().budget().energy;
  run.steps(2 * steps, dt);
  const double rate = -std::log(run.method.flow().budget().energy / early) / (2 * 0.04) / 2;
  return rate / (4 * M_PI * M_PI / 4 / (1 - fraction)) - 1;
}

TEST(SpectralParticles, UniformBubblesActAsMoreViscosity) {
  for (const char* integrator : {"ab2", "rk4"}) {
    const double coarse = std::abs(coupled_decay_error(integrator, 0.004));
    const double fine = std::abs(coupled_decay_error(integrator, 0.002));
    // nu k^2 dt = 0.02: an error of its square, times the fraction of 0.2.
    EXPECT_LT(fine, 2e-4) << integrator;
    EXPECT_GT(std::log2(coarse / fine), 1.6) << integrator << " " << coarse << " " << fine;
  }
}

// Heavy particles, one at every grid point: volume fraction 0.2, density ratio 14.5, mass loading 2.85.
std::string heavy(const std::string& integrator, const std::string& more) {
  return "method = \"spectral\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\nx = \"periodic\"\ny = \"periodic\"\n"
         "z = \"periodic\"\n[resolution]\ngrid = 12\n[time]\nend = 1\ncourant = 0.5\n" +
         random_start + "[spectral]\nintegrator = \"" + integrator +
         "\"\n[particles]\ncount = 1728\ndiameter = 0.0601117\nbeta = 0.1\nplacement = \"lattice\"\n"
         "coupling = \"two-way\"\noverlap_samples = 0\n" +
         more;
}

// Largest energy over that at the start; infinite where a step failed.
double energy_growth(const std::string& text, double share_of_limit, int steps) {
  SpectralRun<> run(text);
  run.start();
  const double start = run.method.flow().budget().energy;
  double largest = start;
  try {
    for (int s = 0; s < steps; ++s) {
      run.steps(1, share_of_limit * run.method.step_limit().dt);
      largest = std::max(largest, run.method.flow().budget().energy);
    }
  } catch (const StepFailure&) {
    return std::numeric_limits<double>::infinity();
  }
  return largest / start;
}

TEST(SpectralParticles, HeavyOnesShortenTheStepToWhereTheirCouplingIsStable) {
  for (const char* integrator : {"ab2", "rk3"}) {
    const std::string text = heavy(integrator, "response_time = 1e-4\n");
    SpectralRun<> run(text);
    run.start();
    EXPECT_EQ(run.method.step_limit().limited_by, "particle coupling") << integrator;
    EXPECT_LT(energy_growth(text, 1, 200), 1.01) << integrator;
    EXPECT_GT(energy_growth(text, 4, 200), 2) << integrator;
    // Particles that respond slowly do not.
    SpectralRun<> slow(heavy(integrator, "response_time = 10\n"));
    slow.start();
    EXPECT_NE(slow.method.step_limit().limited_by, "particle coupling") << integrator;
  }
}

TEST(SpectralParticles, ThatCannotLoseTheirOwnDisturbanceSaySo) {
  SpectralRun<> stiff(heavy("ab2", "response_time = 1e-4\n")), slow(heavy("ab2", "response_time = 10\n"));
  const auto remarks = stiff.method.take_remarks();
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_THAT(remarks[0].text, testing::HasSubstr("particles.remove_self_disturbance has no effect"));
  EXPECT_TRUE(slow.method.take_remarks().empty());
  EXPECT_TRUE(slow.method.suspension()->system().removes_self_disturbance());
  EXPECT_LT(energy_growth(heavy("ab2", "response_time = 10\n"), 1, 200), 1.01);
  EXPECT_LT(energy_growth(heavy("ab2", ""), 1, 200), 1.01);  // of its diameter: an own share of 0.6
}

TEST(SpectralParticles, CouplingThatNoReasonableStepBearsIsRefusedInWords) {
  const auto refusal = [](const std::string& text) {
    try {
      SpectralRun<> run(text);
      run.start();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(
      refusal(heavy("ab2", "response_time = 1e-9\n")),
      testing::AllOf(testing::HasSubstr("mass loading of 2.85"), testing::HasSubstr("raise the response time")));
  EXPECT_THAT(refusal(heavy("ab2", "response_time = 1\nmax_volume_fraction = 0.7\n")),
              testing::HasSubstr("expected at most 0.55"));
  // With the place in the case, as every refusal.
  const std::string text = heavy("ab2", "response_time = 1e-9\n");
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(text.find("response_time")), '\n');
  EXPECT_THAT(refusal(text), testing::HasSubstr(".toml:" + std::to_string(line) + ":17: error: "));
  EXPECT_EQ(refusal(heavy("ab2", "response_time = 1\n")), "");
}

TEST(SpectralParticles, CollideWithoutTheFlowFeelingThem) {
  SpectralRun<> colliding(suspension("colliding")), without(spectral_text("[12, 16, 20]", random_start));
  colliding.start().steps(5, 0.002);
  without.start().steps(5, 0.002);
  EXPECT_EQ(colliding.saved().reals.at("potential_x"), without.saved().reals.at("potential_x"));
  EXPECT_GT(colliding.series().at("collisions"), 0);
  EXPECT_EQ(colliding.series().count("clipped_force"), 0U);
}

// Random places overlap, by 8 % of the volume of these; they start apart, and what the collisions leave is judged.
TEST(SpectralParticles, StartApartAndAreJudgedByTheOverlapThatIsLeft) {
  const std::string dense =
      "[particles]\ncount = 8000\ndiameter = 0.05\nbeta = 3\nresponse_time = 0.05\noverlap_samples = "
      "4000\ncoupling = \"";
  SpectralRun<> colliding(spectral_text("[12, 16, 20]", random_start + dense + "four-way\"\n"));
  colliding.start();
  EXPECT_EQ(colliding.series().at("overlap_ratio"), 0);
  SpectralRun<> passing(spectral_text("[12, 16, 20]", random_start + dense + "one-way\"\n"));
  EXPECT_GT(passing.start().series().at("overlap_ratio"), 0.05);
  std::vector<std::string> judged;
  for (const Invariant& one : colliding.method.invariants()) judged.push_back(one.column);
  EXPECT_THAT(judged, testing::ElementsAre("overlap_ratio", "clipped_force"));
}

// No set in space has more than three dimensions. Of touching spheres the number within a distance rises from nothing.
TEST(SpectralParticles, HaveADimensionOfThreeAtMost) {
  SpectralRun<> run(spectral_text("[12, 16, 20]", random_start +
                                                      "[particles]\ncount = 8000\ndiameter = 0.05\nbeta = 3\n"
                                                      "response_time = 0.05\ncoupling = \"four-way\"\n"));
  run.start();
  for (int row = 0; row < 4; ++row) {
    const double dimension = run.series().at("correlation_dimension");
    EXPECT_LE(dimension, 3);
    EXPECT_GT(dimension, 2.5);
    run.steps(2, 0.002);
  }
}

// Close to what can go wrong: everything in one place, a dense suspension, particles that follow at once or never.
TEST(SpectralParticles, ExtremesStayFiniteAndLoseNobody) {
  const std::string all_in_one_point =
      "count = 2000\ndiameter = 0.03\nresponse_time = 0.05\nplacement = "
      "\"clustered\"\nclusters = 1\ncluster_radius = 1e-9\n";
  const std::string dense = "volume_fraction = 0.3\ndiameter = 0.08\nresponse_time = 0.05\n";
  const std::string swift = "volume_fraction = 0.1\ndiameter = 0.05\nresponse_time = 1e-4\n";
  const std::string slow = "volume_fraction = 0.1\ndiameter = 0.05\nresponse_time = 100\n";
  for (const std::string& which : {all_in_one_point, dense, swift, slow}) {
    SpectralRun<> run(spectral_text("[12, 16, 20]", random_start + "[particles]\nbeta = 3\ncoupling = \"four-way\"\n" +
                                                        "collision_sweeps = 4\n" + which));
    run.start();
    const double start = run.method.flow().budget().energy;
    for (int s = 0; s < 40; ++s) run.steps(1, run.method.step_limit().dt);
    const auto row = run.series();
    for (const auto& [name, value] : row)
      EXPECT_TRUE(std::isfinite(value) || name == "correlation_dimension") << which << name;
    // Bubbles give energy of their own added mass back, of the order of what they took.
    EXPECT_LT(run.method.flow().budget().energy, 1.1 * start) << which;
    const Particles& particles = run.method.suspension()->system().particles();
    std::vector<int> seen(particles.size(), 0);
    for (const std::int64_t id : *particles.identifier) ++seen[static_cast<std::size_t>(id)];
    EXPECT_THAT(seen, testing::Each(1)) << which;
  }
}

TEST(SpectralParticles, AMeanForceDrivesNoMeanFlow) {
  SpectralRun<> run(
      spectral_text("[8, 8, 8]", random_start + bubbles + "coupling = \"two-way\"\ngravity = [0, 0, -1]\n"));
  run.start().steps(10, 0.002);
  for (const auto& component : run.method.flow().potential()) EXPECT_EQ(component[0], std::complex<double>{});
  EXPECT_GT(run.series().at("particle_rms_slip"), 0);
}

// What particles give over a step, the fluid has gained at its end: the box has a volume of 3, rounding is that of the
// sums over 2,000 particles and 4,096 points.
TEST(SpectralParticles, GiveTheFluidAllTheirMomentumWhereNothingHoldsIt) {
  SpectralRun<> run(spectral_text("[16, 16, 16]", random_start + bubbles +
                                                      "coupling = \"two-way\"\nmean_force_moves_fluid = true\n"
                                                      "[spectral]\nintegrator = \"rk4\"\n"));
  run.start().steps(3, 0.002);
  for (int step = 0; step < 3; ++step) {
    const auto force = run.saved().reals.at("particle_amounts");
    std::array<double, 3> before{}, given{}, size{};
    for (std::size_t c = 0; c < 3; ++c) {
      before[c] = run.method.flow().potential()[c][0].real();
      for (std::size_t i = c; i + 1 < force.size(); i += 3) {
        given[c] += 0.002 * force[i] / 3;
        size[c] += 0.002 * std::abs(force[i]) / 3;
      }
    }
    run.steps(1, 0.002);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_GT(std::abs(given[c]), 1e-4 * size[c]);
      EXPECT_NEAR(run.method.flow().potential()[c][0].real() - before[c], given[c], 1e-13 * size[c] + 1e-16) << step;
    }
  }
}

TEST(SpectralParticles, SinglePrecisionFlowsCarryThemToo) {
  SpectralRun<float> run(suspension("four-way") + "[spectral]\nprecision = \"single\"\n");
  SpectralRun<double> exact(suspension("four-way"));
  run.start().steps(5, 0.002);
  exact.start().steps(5, 0.002);
  EXPECT_NEAR(run.series().at("particle_rms_velocity"), exact.series().at("particle_rms_velocity"), 1e-5);
}

}  // namespace
}  // namespace spume
