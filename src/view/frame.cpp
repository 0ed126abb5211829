// SPDX-License-Identifier: MIT
#include "spume/view/frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

namespace spume {
namespace {

// Units of the fields that methods write, in the words of the case.
const std::map<std::string, std::string>& field_units() {
  static const std::map<std::string, std::string> units{{"velocity", "length/time"},
                                                        {"pressure", "mass/(length time2)"},
                                                        {"dissipation", "mass/(length time3)"},
                                                        {"unresolved_dissipation", "mass/(length time3)"},
                                                        {"eddy_viscosity", "length2/time"},
                                                        {"vorticity", "1/time"},
                                                        {"acceleration", "length/time2"},
                                                        {"density", "mass/length3"},
                                                        {"viscosity", "mass/(length time)"},
                                                        {"radius", "length"},
                                                        {"diameter", "length"},
                                                        {"age", "time"},
                                                        {"slip", "length/time"}};
  return units;
}

// A colouring: one component of a field, or the size of the vector.
struct Colouring {
  std::string name, unit;
  std::size_t field = 0;
  int component = -1;  // -1: the size
};

std::vector<Colouring> colourings_of(const std::string& name, std::size_t field, std::size_t components) {
  const auto unit = field_units().find(name);
  const std::string words = unit == field_units().end() ? "" : unit->second;
  if (components == 1) return {{name, words, field, 0}};
  std::vector<Colouring> list{{name, words, field, -1}};
  for (std::size_t axis = 0; axis < std::min<std::size_t>(components, 3); ++axis)
    list.push_back({name + '_' + "xyz"[axis], words, field, static_cast<int>(axis)});
  return list;
}

std::vector<Colouring> all_colourings(const ParticleSnapshot& family) {
  std::vector<Colouring> list;
  for (std::size_t k = 0; k < family.fields.size(); ++k) {
    const ParticleField& field = family.fields[k];
    for (Colouring& one : colourings_of(field.name, k, std::max(field.f64.size(), field.i64.size())))
      list.push_back(std::move(one));
  }
  return list;
}

std::vector<Colouring> all_colourings(const GridSnapshot& grid) {
  std::vector<Colouring> list;
  for (std::size_t k = 0; k < grid.fields.size(); ++k)
    for (Colouring& one : colourings_of(grid.fields[k].name, k, grid.fields[k].components.size()))
      list.push_back(std::move(one));
  return list;
}

// The wanted one, or the first; null without any.
const Colouring* chosen(const std::vector<Colouring>& list, const std::string& family, const FrameWish& wish) {
  if (list.empty()) return nullptr;
  const auto wanted = wish.fields.find(family);
  if (wanted == wish.fields.end()) return &list.front();
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Colouring& one) { return one.name == wanted->second; });
  return found == list.end() ? &list.front() : &*found;
}

template <class T>
double value_of(const std::vector<const T*>& components, int component, std::size_t i) {
  if (component >= 0) return static_cast<double>(components[static_cast<std::size_t>(component)][i]);
  double sum = 0;
  for (const T* one : components) sum += static_cast<double>(one[i]) * static_cast<double>(one[i]);
  return std::sqrt(sum);
}

struct CodeRange {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void close() {  // of nothing: 0 to 0
    if (!(low <= high)) low = high = 0;
  }
};

// Codes from 0 to `top` for low to high; top + 1 for what is not finite.
template <class Code>
Code coded(double value, const CodeRange& bounds, double steps_per_unit, double top) {
  if (!std::isfinite(value)) return static_cast<Code>(top + 1);
  return static_cast<Code>(std::clamp((value - bounds.low) * steps_per_unit + 0.5, 0.0, top));
}

double steps_per_unit(const CodeRange& bounds, double top) {
  const double width = bounds.high - bounds.low;
  const double steps = top / width;
  return width > 0 && std::isfinite(steps) ? steps : 0;
}

class Payload {
 public:
  // The place of an array of `bytes` bytes.
  std::size_t add(std::size_t bytes) {
    const std::size_t at = (bytes_.size() + 3) / 4 * 4;
    bytes_.resize(at + bytes);
    return at;
  }
  template <class Code>
  Code* codes(std::size_t at) {
    return reinterpret_cast<Code*>(bytes_.data() + at);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Writes values of 8 or 16 bits and says in the block where they are and what they mean.
template <class Value>
void add_values(nlohmann::json& block, Payload& payload, std::size_t count, int bits, Value&& value) {
  CodeRange bounds;
  for (std::size_t k = 0; k < count; ++k) bounds.include(value(k));
  bounds.close();
  const double top = bits == 8 ? 254 : 65534;
  const double scale = steps_per_unit(bounds, top);
  const std::size_t at = payload.add(count * static_cast<std::size_t>(bits / 8));
  if (bits == 8)
    for (std::size_t k = 0; k < count; ++k)
      payload.codes<std::uint8_t>(at)[k] = coded<std::uint8_t>(value(k), bounds, scale, top);
  else
    for (std::size_t k = 0; k < count; ++k)
      payload.codes<std::uint16_t>(at)[k] = coded<std::uint16_t>(value(k), bounds, scale, top);
  block["values"] = {{"at", at}, {"bits", bits}, {"low", bounds.low}, {"high", bounds.high}};
}

// Those of a family that are sent: the same ones in every frame as long as their identifiers stay.
std::vector<std::uint32_t> selection(const ParticleSnapshot& family, std::size_t most) {
  std::vector<std::uint32_t> selected;
  if (family.size <= most) {
    selected.resize(family.size);
    std::iota(selected.begin(), selected.end(), 0U);
    return selected;
  }
  const std::int64_t* id = nullptr;
  for (const ParticleField& field : family.fields)
    if (field.name == "id" && !field.i64.empty()) id = field.i64[0];
  selected.reserve(most);
  if (id == nullptr) {
    const double stride = static_cast<double>(family.size) / static_cast<double>(most);
    for (std::size_t k = 0; k < most; ++k)
      selected.push_back(static_cast<std::uint32_t>(stride * static_cast<double>(k)));
    return selected;
  }
  // Multiples of 2^32 over the golden ratio spread any run of numbers evenly (Knuth, The Art of Computer Programming 3,
  // 6.4); a little less than `most` is aimed at, as many come up on the average only.
  const double share = 0.98 * static_cast<double>(most) / static_cast<double>(family.size);
  const auto threshold = static_cast<std::uint32_t>(share * 4294967296.0);
  for (std::size_t i = 0; i < family.size && selected.size() < most; ++i)
    if (static_cast<std::uint32_t>(id[i]) * 2654435769U < threshold) selected.push_back(static_cast<std::uint32_t>(i));
  return selected;
}

void add_positions(nlohmann::json& block, Payload& payload, const ParticleSnapshot& family,
                   const std::vector<std::uint32_t>& selected) {
  const std::size_t dimensions = family.position.size();
  std::array<CodeRange, 3> box;
  for (std::size_t axis = 0; axis < dimensions; ++axis) {
    for (const std::uint32_t i : selected) box[axis].include(family.position[axis][i]);
    box[axis].close();
    block["lower"].push_back(box[axis].low);
    block["upper"].push_back(box[axis].high);
  }
  const std::size_t at = payload.add(selected.size() * dimensions * 2);
  auto* const codes = payload.codes<std::uint16_t>(at);
  for (std::size_t axis = 0; axis < dimensions; ++axis) {
    const double scale = steps_per_unit(box[axis], 65535);
    const double* const position = family.position[axis];
    for (std::size_t k = 0; k < selected.size(); ++k) {
      const double x = position[selected[k]];
      const double finite = std::isfinite(x) ? x : box[axis].low;  // which a step with such a result is refused for
      codes[k * dimensions + axis] = coded<std::uint16_t>(finite, box[axis], scale, 65535);
    }
  }
  block["positions"] = {{"at", at}};
}

void add_sizes(nlohmann::json& block, Payload& payload, const ParticleSnapshot& family,
               const std::vector<std::uint32_t>& selected) {
  for (const ParticleField& field : family.fields) {
    if ((field.name != "radius" && field.name != "diameter") || field.f64.size() != 1) continue;
    const double to_diameter = field.name == "radius" ? 2 : 1;
    CodeRange sizes{0, 0};
    for (const std::uint32_t i : selected) sizes.include(to_diameter * field.f64[0][i]);
    sizes.low = 0;
    const double scale = steps_per_unit(sizes, 65534);
    const std::size_t at = payload.add(selected.size() * 2);
    for (std::size_t k = 0; k < selected.size(); ++k)
      payload.codes<std::uint16_t>(at)[k] =
          coded<std::uint16_t>(to_diameter * field.f64[0][selected[k]], sizes, scale, 65534);
    block["sizes"] = {{"at", at}, {"largest", sizes.high}};
    return;
  }
}

template <class Family>
nlohmann::json new_block(const char* kind, const Family& family, const std::vector<Colouring>& list,
                         const Colouring* colour) {
  nlohmann::json block{{"kind", kind}, {"family", family.name}, {"colourings", nlohmann::json::array()}};
  for (const Colouring& one : list) block["colourings"].push_back(one.name);
  if (colour != nullptr) {
    block["field"] = colour->name;
    block["unit"] = colour->unit;
  }
  return block;
}

nlohmann::json particle_block(const ParticleSnapshot& family, std::size_t most, const FrameWish& wish,
                              Payload& payload) {
  const std::vector<Colouring> list = all_colourings(family);
  const Colouring* const colour = chosen(list, family.name, wish);
  nlohmann::json block = new_block("particles", family, list, colour);
  const std::vector<std::uint32_t> selected = selection(family, most);
  block["dimensions"] = family.position.size();
  block["total"] = family.size;
  block["count"] = selected.size();
  add_positions(block, payload, family, selected);
  if (colour != nullptr) {
    const ParticleField& field = family.fields[colour->field];
    if (!field.f64.empty())
      add_values(block, payload, selected.size(), wish.bits,
                 [&](std::size_t k) { return value_of(field.f64, colour->component, selected[k]); });
    else
      add_values(block, payload, selected.size(), wish.bits,
                 [&](std::size_t k) { return value_of(field.i64, colour->component, selected[k]); });
  }
  add_sizes(block, payload, family, selected);
  return block;
}

nlohmann::json plane_block(const GridSnapshot& grid, const FrameWish& wish, Payload& payload) {
  const std::vector<Colouring> list = all_colourings(grid);
  const Colouring* const colour = chosen(list, grid.name, wish);
  nlohmann::json block = new_block("plane", grid, list, colour);
  const auto normal = static_cast<std::size_t>(std::clamp(wish.plane_axis, 0, 2));
  const std::size_t across = normal == 0 ? 1 : 0, along = normal == 2 ? 1 : 2;
  const auto last = static_cast<double>(grid.points[normal] - 1);
  const auto layer = static_cast<std::size_t>(std::clamp(wish.plane_at, 0.0, 1.0) * last + 0.5);
  const auto thinned = [&](std::size_t axis) {
    return (grid.points[axis] + most_plane_points - 1) / most_plane_points;  // points per point that is sent
  };
  const std::size_t skip_across = thinned(across), skip_along = thinned(along);
  const std::size_t columns = grid.points[across] / skip_across, rows = grid.points[along] / skip_along;
  block["axes"] = {across, along, normal};
  block["columns"] = columns;
  block["rows"] = rows;
  block["place"] = grid.origin[normal] + static_cast<double>(layer) * grid.spacing[normal];
  for (const std::size_t axis : {across, along}) {
    block["lower"].push_back(grid.origin[axis]);
    block["upper"].push_back(grid.origin[axis] + static_cast<double>(grid.points[axis]) * grid.spacing[axis]);
  }
  if (colour == nullptr) return block;
  const auto& components = grid.fields[colour->field].components;
  add_values(block, payload, columns * rows, wish.bits, [&](std::size_t k) {
    std::array<std::size_t, 3> point{};
    point[across] = k % columns * skip_across;
    point[along] = k / columns * skip_along;
    point[normal] = layer;
    const std::size_t i = (point[0] * grid.points[1] + point[1]) * grid.points[2] + point[2];
    return value_of(components, colour->component, i);
  });
  return block;
}

}  // namespace

std::vector<std::string> colourings(const ParticleSnapshot& family) {
  std::vector<std::string> names;
  for (const Colouring& one : all_colourings(family)) names.push_back(one.name);
  return names;
}

std::string make_frame(std::int64_t step, double time, const std::vector<ParticleSnapshot>& families,
                       const std::vector<GridSnapshot>& grids, const FrameWish& wish) {
  Payload payload;
  nlohmann::json blocks = nlohmann::json::array();
  for (const GridSnapshot& grid : grids) blocks.push_back(plane_block(grid, wish, payload));
  // A family with less than its share leaves the rest to those that come after it in size.
  std::vector<const ParticleSnapshot*> by_size;
  for (const ParticleSnapshot& family : families) by_size.push_back(&family);
  std::sort(by_size.begin(), by_size.end(), [](const auto* a, const auto* b) { return a->size < b->size; });
  std::size_t left = std::min(wish.points, most_frame_points);
  std::map<const ParticleSnapshot*, std::size_t> shares;
  for (std::size_t k = 0; k < by_size.size(); ++k) {
    shares[by_size[k]] = std::min(by_size[k]->size, left / (by_size.size() - k));
    left -= shares[by_size[k]];
  }
  for (const ParticleSnapshot& family : families)
    blocks.push_back(particle_block(family, shares[&family], wish, payload));

  std::string header = nlohmann::json{{"step", step}, {"time", time}, {"blocks", std::move(blocks)}}.dump(
      -1, ' ', false, nlohmann::json::error_handler_t::replace);
  header.resize((header.size() + 3) / 4 * 4, ' ');
  const auto length = static_cast<std::uint32_t>(header.size());
  std::string frame(sizeof length, '\0');
  std::memcpy(frame.data(), &length, sizeof length);
  frame.reserve(frame.size() + header.size() + payload.bytes().size());
  return (frame += header) += payload.bytes();
}

}  // namespace spume
