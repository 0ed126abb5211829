// SPDX-License-Identifier: MIT
#include "colouring.hpp"

#include <algorithm>

#include "spume/view/field_words.hpp"

namespace spume {
namespace {

void add_colourings(std::vector<Colouring>& list, const std::string& name, std::size_t field, std::size_t components) {
  const auto known = field_words().find(name);
  const std::string unit = known == field_words().end() ? "" : known->second.unit;
  list.push_back({name, unit, field, components == 1 ? 0 : -1});
  if (components == 1) return;
  for (std::size_t axis = 0; axis < std::min<std::size_t>(components, 3); ++axis)
    list.push_back({name + '_' + "xyz"[axis], unit, field, static_cast<int>(axis)});
}

}  // namespace

const std::map<std::string, FieldWords>& field_words() {
  static const std::map<std::string, FieldWords> words{
      {"velocity", {"length/time", "u = dx/dt"}},
      {"pressure", {"mass/(length time2)", "p, of rho du/dt = -grad p + ...; 0 at a free surface"}},
      {"id", {"", "number that the particle keeps"}},
      {"phase", {"", "number of the particle's [[phase]], from 0"}},
      {"density", {"mass/length3", "rho = mass over volume"}},
      {"viscosity", {"mass/(length time)", "mu, of the shear stress 2 mu S with S = (grad u + grad u^T)/2"}},
      {"eddy_viscosity",
       {"length2/time", "nu_t of the turbulence model, of the stress 2 rho nu_t S that is not resolved"}},
      {"dissipation", {"length2/time3", "2 (nu + nu_t) S : S, with S = (grad u + grad u^T)/2"}},
      {"unresolved_dissipation", {"length2/time3", "2 nu_t S : S, with S = (grad u + grad u^T)/2"}},
      {"divergence_of_position",
       {"", "div r = sum of V_j (r_j - r_i) . grad W: 2 or 3 inside, less at a free surface"}},
      {"volume_fraction", {"", "alpha: share of the volume that is liquid and not bubbles"}},
      {"diffusion", {"length/time2", "(1/rho) div(2 mu S): acceleration by viscosity"}},
      {"colour", {"", "smoothed share of the last phase: from 0 to 1 across its interface"}},
      {"interface_potential",
       {"mass/(length time2)",
        "phi = sigma kappa - (rho_n - rho_0) g . (x_I - x_0): tension and gravity at the interface"}},
      {"acceleration", {"length/time2", "du/dt by all forces"}},
      {"vorticity", {"1/time", "omega = curl u"}},
      {"radius", {"length", "r of a sphere of the bubble's volume"}},
      {"diameter", {"length", "d of a sphere of the particle's volume"}},
      {"age", {"time", "t - t0, with t0 the time at which the bubble came to be"}},
      {"slip", {"length/time", "|u_b - u|: speed against the resolved liquid"}}};
  return words;
}

std::vector<Colouring> all_colourings(const ParticleSnapshot& family) {
  std::vector<Colouring> list;
  for (std::size_t k = 0; k < family.fields.size(); ++k) {
    const ParticleField& field = family.fields[k];
    add_colourings(list, field.name, k, std::max(field.f64.size(), field.i64.size()));
  }
  return list;
}

std::vector<Colouring> all_colourings(const GridSnapshot& grid) {
  std::vector<Colouring> list;
  for (std::size_t k = 0; k < grid.fields.size(); ++k)
    add_colourings(list, grid.fields[k].name, k, grid.fields[k].components.size());
  return list;
}

const Colouring* chosen(const std::vector<Colouring>& list, const std::string& family, const FrameWish& wish) {
  if (list.empty()) return nullptr;
  const auto wanted = wish.fields.find(family);
  if (wanted == wish.fields.end()) return &list.front();
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Colouring& one) { return one.name == wanted->second; });
  return found == list.end() ? &list.front() : &*found;
}

std::vector<std::string> colourings(const ParticleSnapshot& family) {
  std::vector<std::string> names;
  for (const Colouring& one : all_colourings(family)) names.push_back(one.name);
  return names;
}

}  // namespace spume
