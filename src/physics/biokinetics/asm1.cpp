// SPDX-License-Identifier: MIT
#include "spume/physics/biokinetics/asm1.hpp"

#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <utility>

namespace spume::biokinetics {
namespace {

using namespace asm1;
using Kind = Factor::Kind;

// g COD per g N: of nitrate reduced to dinitrogen, and of ammonia oxidised to nitrate. The rounded values of the model
// as published; COD closes with them (their difference is that of dinitrogen).
constexpr double nitrate_to_dinitrogen = 2.86, ammonia_to_nitrate = 4.57;
constexpr double nitrogen_molar_mass = 14;  // g/mol, as published

Factor linear(std::size_t a) {
  return {Kind::linear, a};
}
Factor saturation(std::size_t a, double k) {
  return {Kind::saturation, a, k};
}
Factor inhibition(std::size_t a, double k) {
  return {Kind::inhibition, a, k};
}

std::vector<double> row(std::initializer_list<std::pair<Component, double>> entries) {
  std::vector<double> numbers(components, 0.0);
  for (const auto& [component, number] : entries) numbers[component] = number;
  return numbers;
}

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

void check(const Asm1Parameters& p) {
  for (const double yield : {p.y_a, p.y_h}) require(yield > 0 && yield < 1, "ASM1: a yield is not between 0 and 1");
  for (const double share : {p.f_p, p.i_xb, p.i_xp, p.eta_g, p.eta_h})
    require(share >= 0 && share <= 1, "ASM1: a share is not between 0 and 1");
  for (const double number : {p.mu_h, p.k_s, p.k_oh, p.k_no, p.b_h, p.k_h, p.k_x, p.mu_a, p.k_nh, p.k_oa, p.b_a, p.k_a,
                              p.k_nutrient, p.k_alkalinity})
    require(number >= 0, "ASM1: a rate or a half-saturation is negative or not a number");
}

}  // namespace

Asm1Parameters Asm1Parameters::at(double temperature) {
  Asm1Parameters p;
  // Values at 10 degrees: IWA benchmark no. 2.
  const auto correct = [temperature](double& at15, double at10) {
    at15 *= std::exp(std::log(at15 / at10) / 5 * (temperature - 15));
  };
  correct(p.mu_h, 3);
  correct(p.b_h, 0.2);
  correct(p.mu_a, 0.3);
  correct(p.b_a, 0.03);
  correct(p.k_h, 2.5);
  correct(p.k_a, 0.04);
  return p;
}

Model asm1_model(const Asm1Parameters& p) {
  check(p);
  const Factor oxic = saturation(s_o, p.k_oh), anoxic = inhibition(s_o, p.k_oh), nitrate = saturation(s_no, p.k_no);
  const Factor surface = {Kind::surface, x_s, p.k_x, x_bh};
  // Hydrolysis of the substance a held by X_S: k_h a X_BH / (K_X X_BH + X_S), with oxygen and with nitrate.
  const auto hydrolysis = [&](Component a) {
    return std::vector<Term>{{p.k_h, {linear(a), linear(x_bh), surface, oxic}},
                             {p.eta_h * p.k_h, {linear(a), linear(x_bh), surface, anoxic, nitrate}}};
  };
  const double m = nitrogen_molar_mass, held = p.i_xb - p.f_p * p.i_xp;
  const double reduced = (1 - p.y_h) / (nitrate_to_dinitrogen * p.y_h);
  Model model{
      {"S_I", "S_S", "X_I", "X_S", "X_BH", "X_BA", "X_P", "S_O", "S_NO", "S_NH", "S_ND", "X_ND", "S_ALK"},
      {
          {"aerobic growth of heterotrophs",
           {{p.mu_h, {saturation(s_s, p.k_s), oxic, linear(x_bh)}}},
           row({{s_s, -1 / p.y_h}, {x_bh, 1}, {s_o, -(1 - p.y_h) / p.y_h}, {s_nh, -p.i_xb}, {s_alk, -p.i_xb / m}})},
          {"anoxic growth of heterotrophs",
           {{p.eta_g * p.mu_h, {saturation(s_s, p.k_s), anoxic, nitrate, linear(x_bh)}}},
           row({{s_s, -1 / p.y_h}, {x_bh, 1}, {s_no, -reduced}, {s_nh, -p.i_xb}, {s_alk, (reduced - p.i_xb) / m}})},
          {"aerobic growth of autotrophs",
           {{p.mu_a, {saturation(s_nh, p.k_nh), saturation(s_o, p.k_oa), linear(x_ba)}}},
           row({{x_ba, 1},
                {s_o, -(ammonia_to_nitrate - p.y_a) / p.y_a},
                {s_no, 1 / p.y_a},
                {s_nh, -p.i_xb - 1 / p.y_a},
                {s_alk, -(p.i_xb + 2 / p.y_a) / m}})},
          {"decay of heterotrophs",
           {{p.b_h, {linear(x_bh)}}},
           row({{x_s, 1 - p.f_p}, {x_bh, -1}, {x_p, p.f_p}, {x_nd, held}})},
          {"decay of autotrophs",
           {{p.b_a, {linear(x_ba)}}},
           row({{x_s, 1 - p.f_p}, {x_ba, -1}, {x_p, p.f_p}, {x_nd, held}})},
          {"ammonification", {{p.k_a, {linear(s_nd), linear(x_bh)}}}, row({{s_nh, 1}, {s_nd, -1}, {s_alk, 1 / m}})},
          {"hydrolysis of organics", hydrolysis(x_s), row({{s_s, 1}, {x_s, -1}})},
          {"hydrolysis of organic nitrogen", hydrolysis(x_nd), row({{s_nd, 1}, {x_nd, -1}})},
      }};
  // Nitrifiers have a half-saturation of ammonia, and denitrification makes alkalinity.
  for (const std::size_t growth : {0, 1})
    if (p.k_nutrient > 0) model.processes[growth].rate[0].factors.push_back(saturation(s_nh, p.k_nutrient));
  for (const std::size_t growth : {0, 2})
    if (p.k_alkalinity > 0) model.processes[growth].rate[0].factors.push_back(saturation(s_alk, p.k_alkalinity));
  return model;
}

Asm1Content asm1_cod() {
  Asm1Content content{};
  for (const Component c : {s_i, s_s, x_i, x_s, x_bh, x_ba, x_p}) content[c] = 1;
  content[s_o] = -1;
  content[s_no] = -ammonia_to_nitrate;
  return content;
}

Asm1Content asm1_nitrogen(const Asm1Parameters& p) {
  Asm1Content content{};
  for (const Component c : {s_no, s_nh, s_nd, x_nd}) content[c] = 1;
  content[x_bh] = content[x_ba] = p.i_xb;
  content[x_p] = p.i_xp;
  return content;
}

Asm1Content asm1_charge() {
  Asm1Content content{};
  content[s_nh] = 1 / nitrogen_molar_mass;
  content[s_no] = -1 / nitrogen_molar_mass;
  content[s_alk] = -1;
  return content;
}

}  // namespace spume::biokinetics
