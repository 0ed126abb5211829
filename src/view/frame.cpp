// SPDX-License-Identifier: MIT
#include "spume/view/frame.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

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

// The finite ones of some values lie from low to high.
struct CodeRange {
  double low = 0, high = 0;
};

// Infinities and what is no number give neither true.
inline bool is_finite(double value) {
  return value - value == 0;
}

CodeRange range_of(const double* values, std::size_t count) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
#pragma omp simd reduction(min : low) reduction(max : high)
  for (std::size_t k = 0; k < count; ++k) {
    low = is_finite(values[k]) && values[k] < low ? values[k] : low;
    high = is_finite(values[k]) && values[k] > high ? values[k] : high;
  }
  if (!(low <= high)) return {};
  return {low, high};
}

// Codes from 0 to `top` for low to high, every `stride` places; `odd` for what is not finite.
template <class Code>
void write_codes(const double* values, std::size_t count, const CodeRange& range, int top, int odd, Code* codes,
                 std::size_t stride) {
  const double steps = top / (range.high - range.low);
  const double scale = range.high > range.low && is_finite(steps) ? steps : 0, low = range.low, last = top;
#pragma omp simd
  for (std::size_t k = 0; k < count; ++k) {
    const double place = (values[k] - low) * scale + 0.5;
    // What is not finite stays so, or is 0 times infinity.
    const double within = place > 0 ? (place < last ? place : last) : 0;
    codes[k * stride] = static_cast<Code>(is_finite(values[k]) ? static_cast<int>(within) : odd);
  }
}

// The frame as it grows.
class Payload {
 public:
  explicit Payload(std::string& bytes) : bytes_(bytes) { bytes_.assign(start, '\0'); }
  // The place of an array of `bytes` bytes.
  std::size_t add(std::size_t bytes) {
    const std::size_t at = (bytes_.size() - start + 3) / 4 * 4;
    bytes_.resize(start + at + bytes);
    return at;
  }
  template <class Code>
  Code* codes(std::size_t at) {
    return reinterpret_cast<Code*>(bytes_.data() + start + at);
  }
  void finish(const nlohmann::json& header) {
    const auto length = static_cast<std::uint32_t>(bytes_.size() - start);
    std::memcpy(bytes_.data(), &length, sizeof length);
    bytes_ += header.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

 private:
  static constexpr std::size_t start = sizeof(std::uint32_t);
  std::string& bytes_;
};

// Writes values of 8 or 16 bits and says in the block where they are and what they mean.
void add_values(nlohmann::json& block, Payload& payload, const double* values, std::size_t count, int bits) {
  const CodeRange range = range_of(values, count);
  const std::size_t at = payload.add(count * static_cast<std::size_t>(bits / 8));
  if (bits == 8)
    write_codes(values, count, range, 254, 255, payload.codes<std::uint8_t>(at), 1);
  else
    write_codes(values, count, range, 65534, 65535, payload.codes<std::uint16_t>(at), 1);
  block["values"] = {{"at", at}, {"bits", bits}, {"low", range.low}, {"high", range.high}};
}

// The particles of a family that are sent, and values of theirs.
class Selection {
 public:
  // The same ones in every frame as long as their identifiers stay.
  Selection(const ParticleSnapshot& family, std::size_t most, FrameScratch& scratch)
      : size_(std::min(family.size, most)), selected_(scratch.selected), values_(scratch.values) {
    selected_.clear();
    if (family.size <= most) return;
    all_ = false;
    selected_.reserve(most);
    const std::int64_t* id = nullptr;
    for (const ParticleField& field : family.fields)
      if (field.name == "id" && !field.i64.empty()) id = field.i64[0];
    if (id == nullptr) {
      const double stride = static_cast<double>(family.size) / static_cast<double>(most);
      for (std::size_t k = 0; k < most; ++k)
        selected_.push_back(static_cast<std::uint32_t>(stride * static_cast<double>(k)));
      return;
    }
    // Multiples of 2^32 over the golden ratio spread any run of numbers evenly (Knuth, The Art of Computer Programming
    // 3, 6.4); a little less than `most` is aimed at, as many come up on the average only.
    const double share = 0.98 * static_cast<double>(most) / static_cast<double>(family.size);
    const auto threshold = static_cast<std::uint32_t>(share * 4294967296.0);
    for (std::size_t i = 0; i < family.size && selected_.size() < most; ++i)
      if (static_cast<std::uint32_t>(id[i]) * 2654435769U < threshold)
        selected_.push_back(static_cast<std::uint32_t>(i));
    size_ = selected_.size();
  }
  std::size_t size() const { return size_; }

  // One component; the pointer holds until the next call.
  template <class T>
  const double* values(const T* source) {
    if constexpr (std::is_same_v<T, double>)
      if (all_) return source;
    values_.resize(size_);
    for (std::size_t k = 0; k < size_; ++k) values_[k] = static_cast<double>(source[place(k)]);
    return values_.data();
  }
  // The size of a vector.
  template <class T>
  const double* sizes(const std::vector<const T*>& components) {
    values_.assign(size_, 0.0);
    for (const T* one : components)
      for (std::size_t k = 0; k < size_; ++k) {
        const auto value = static_cast<double>(one[place(k)]);
        values_[k] += value * value;
      }
    for (double& value : values_) value = std::sqrt(value);
    return values_.data();
  }
  template <class T>
  const double* values(const std::vector<const T*>& components, int component) {
    return component < 0 ? sizes(components) : values(components[static_cast<std::size_t>(component)]);
  }

 private:
  std::size_t place(std::size_t k) const { return all_ ? k : selected_[k]; }
  std::size_t size_;
  bool all_ = true;
  std::vector<std::uint32_t>& selected_;
  std::vector<double>& values_;
};

void add_positions(nlohmann::json& block, Payload& payload, const ParticleSnapshot& family, Selection& selected) {
  const std::size_t dimensions = family.position.size();
  const std::size_t at = payload.add(selected.size() * dimensions * 2);
  for (std::size_t axis = 0; axis < dimensions; ++axis) {
    const double* const place = selected.values(family.position[axis]);
    const CodeRange box = range_of(place, selected.size());
    // A step that leaves a particle at no finite place is refused, so that nothing stands for one.
    write_codes(place, selected.size(), box, 65535, 0, payload.codes<std::uint16_t>(at) + axis, dimensions);
    block["lower"].push_back(box.low);
    block["upper"].push_back(box.high);
  }
  block["positions"] = {{"at", at}};
}

void add_sizes(nlohmann::json& block, Payload& payload, const ParticleSnapshot& family, Selection& selected) {
  for (const ParticleField& field : family.fields) {
    if ((field.name != "radius" && field.name != "diameter") || field.f64.size() != 1) continue;
    const double* const values = selected.values(field.f64[0]);
    const CodeRange sizes{0, std::max(0.0, range_of(values, selected.size()).high)};
    const std::size_t at = payload.add(selected.size() * 2);
    write_codes(values, selected.size(), sizes, 65534, 65535, payload.codes<std::uint16_t>(at), 1);
    block["sizes"] = {{"at", at}, {"largest", (field.name == "radius" ? 2 : 1) * sizes.high}};
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

nlohmann::json particle_block(const ParticleSnapshot& family, std::size_t most, const FrameWish& wish, Payload& payload,
                              FrameScratch& scratch) {
  const std::vector<Colouring> list = all_colourings(family);
  const Colouring* const colour = chosen(list, family.name, wish);
  nlohmann::json block = new_block("particles", family, list, colour);
  Selection selected(family, most, scratch);
  block["dimensions"] = family.position.size();
  block["total"] = family.size;
  block["count"] = selected.size();
  add_positions(block, payload, family, selected);
  if (colour != nullptr) {
    const ParticleField& field = family.fields[colour->field];
    const double* const values = field.f64.empty() ? selected.values(field.i64, colour->component)
                                                   : selected.values(field.f64, colour->component);
    add_values(block, payload, values, selected.size(), wish.bits);
  }
  add_sizes(block, payload, family, selected);
  return block;
}

nlohmann::json plane_block(const GridSnapshot& grid, const FrameWish& wish, Payload& payload, FrameScratch& scratch) {
  const std::vector<Colouring> list = all_colourings(grid);
  const Colouring* const colour = chosen(list, grid.name, wish);
  nlohmann::json block = new_block("plane", grid, list, colour);
  const auto normal = static_cast<std::size_t>(std::clamp(wish.plane_axis, 0, 2));
  const std::size_t across = normal == 0 ? 1 : 0, along = normal == 2 ? 1 : 2;
  const auto last = static_cast<double>(grid.points[normal] - 1);
  const auto layer = static_cast<std::size_t>(std::lround(std::clamp(wish.plane_at, 0.0, 1.0) * last));
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
  std::vector<double>& values = scratch.values;
  values.resize(columns * rows);
  for (std::size_t k = 0; k < values.size(); ++k) {
    std::array<std::size_t, 3> point{};
    point[across] = k % columns * skip_across;
    point[along] = k / columns * skip_along;
    point[normal] = layer;
    const std::size_t i = (point[0] * grid.points[1] + point[1]) * grid.points[2] + point[2];
    double squares = 0;
    for (const float* one : components) squares += static_cast<double>(one[i]) * static_cast<double>(one[i]);
    values[k] = colour->component < 0 ? std::sqrt(squares)
                                      : static_cast<double>(components[static_cast<std::size_t>(colour->component)][i]);
  }
  add_values(block, payload, values.data(), values.size(), wish.bits);
  return block;
}

}  // namespace

std::vector<std::string> colourings(const ParticleSnapshot& family) {
  std::vector<std::string> names;
  for (const Colouring& one : all_colourings(family)) names.push_back(one.name);
  return names;
}

// At most this many frames are on their way: one a viewer, and one that is made.
std::shared_ptr<std::string> FrameMaker::free_buffer() {
  for (const auto& buffer : buffers_)
    if (buffer.use_count() == 1) {
      std::atomic_thread_fence(std::memory_order_acquire);  // what its last reader did comes before
      return buffer;
    }
  return buffers_.emplace_back(std::make_shared<std::string>());
}

std::shared_ptr<const std::string> FrameMaker::make(std::int64_t step, double time,
                                                    const std::vector<ParticleSnapshot>& families,
                                                    const std::vector<GridSnapshot>& grids, const FrameWish& wish) {
  const std::shared_ptr<std::string> frame = free_buffer();
  Payload payload(*frame);
  nlohmann::json blocks = nlohmann::json::array();
  for (const GridSnapshot& grid : grids) blocks.push_back(plane_block(grid, wish, payload, scratch_));
  // A family with less than its share leaves the rest to those that come after it in size.
  std::vector<const ParticleSnapshot*> by_size;
  by_size.reserve(families.size());
  for (const ParticleSnapshot& family : families) by_size.push_back(&family);
  std::sort(by_size.begin(), by_size.end(), [](const auto* a, const auto* b) { return a->size < b->size; });
  std::size_t left = std::min(wish.points, most_frame_points);
  std::map<const ParticleSnapshot*, std::size_t> shares;
  for (std::size_t k = 0; k < by_size.size(); ++k) {
    shares[by_size[k]] = std::min(by_size[k]->size, left / (by_size.size() - k));
    left -= shares[by_size[k]];
  }
  for (const ParticleSnapshot& family : families)
    blocks.push_back(particle_block(family, shares[&family], wish, payload, scratch_));
  payload.finish({{"step", step}, {"time", time}, {"blocks", std::move(blocks)}});
  return frame;
}

}  // namespace spume
