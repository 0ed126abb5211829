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

#include "colouring.hpp"
#include "places.hpp"
#include "spume/core/parallel.hpp"

namespace spume {
namespace {

// The finite ones of some values lie from low to high.
struct CodeRange {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void join(const CodeRange& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  // From 0 to 0 without any.
  CodeRange known() const { return low <= high ? *this : CodeRange{0, 0}; }
};

// Infinities and what is no number give neither true.
inline bool is_finite(double value) {
  return value - value == 0;
}

CodeRange range_of(const double* values, std::size_t count) {
  CodeRange range;
  double low = range.low, high = range.high;
#pragma omp simd reduction(min : low) reduction(max : high)
  for (std::size_t k = 0; k < count; ++k) {
    low = is_finite(values[k]) && values[k] < low ? values[k] : low;
    high = is_finite(values[k]) && values[k] > high ? values[k] : high;
  }
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
  const CodeRange range = range_of(values, count).known();
  const std::size_t at = payload.add(count * static_cast<std::size_t>(bits / 8));
  if (bits == 8)
    write_codes(values, count, range, 254, 255, payload.codes<std::uint8_t>(at), 1);
  else
    write_codes(values, count, range, 65534, 65535, payload.codes<std::uint16_t>(at), 1);
  block["values"] = {{"at", at}, {"bits", bits}, {"low", range.low}, {"high", range.high}};
}

// Particles that are coded at a time.
constexpr std::size_t coded_at_a_time = 2048;

// The particles of a family that are sent.
class Selection {
 public:
  // The same ones in every frame as long as their identifiers stay.
  Selection(const ParticleSnapshot& family, std::size_t most, FrameScratch& scratch)
      : size_(std::min(family.size, most)), selected_(scratch.selected) {
    selected_.clear();
    if (family.size <= most) return;
    all_ = false;
    selected_.reserve(most);
    const std::int64_t* const id = identifiers(family);
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

  // One component from `first` to `last`, where they are or in the buffer.
  template <class T>
  const double* read(const T* source, std::size_t first, std::size_t last, double* buffer) const {
    if constexpr (std::is_same_v<T, double>)
      if (all_) return source + first;
    for (std::size_t k = first; k < last; ++k) buffer[k - first] = static_cast<double>(source[place(k)]);
    return buffer;
  }
  // One component or the size of a vector.
  template <class T>
  const double* read(const std::vector<const T*>& components, int component, std::size_t first, std::size_t last,
                     double* buffer) const {
    if (component >= 0) return read(components[static_cast<std::size_t>(component)], first, last, buffer);
    std::fill_n(buffer, last - first, 0.0);
    for (const T* one : components)
      for (std::size_t k = first; k < last; ++k) {
        const auto value = static_cast<double>(one[place(k)]);
        buffer[k - first] += value * value;
      }
    for (std::size_t k = 0; k < last - first; ++k) buffer[k] = std::sqrt(buffer[k]);
    return buffer;
  }

 private:
  std::size_t place(std::size_t k) const { return all_ ? k : selected_[k]; }
  std::size_t size_;
  bool all_ = true;
  std::vector<std::uint32_t>& selected_;
};

// Numbers of every particle that become codes: places, a value, a size, a phase.
class CodeColumns {
 public:
  CodeColumns(const Selection& selected, Payload& payload, FrameScratch& scratch)
      : selected_(selected), payload_(payload), gathered_(scratch.gathered) {}

  // `bits` 8 or 16; codes from 0 to `top` stand for the range, `odd` for what is not finite.
  void add(const ParticleField& field, int component, std::size_t at, std::size_t offset, std::size_t stride, int bits,
           int top, int odd) {
    columns_.push_back({&field, component, at, offset, stride, bits, top, odd, {}, {}, nullptr});
  }
  // The range that the codes of a column will span, before they are written.
  CodeRange& range(std::size_t column) { return columns_[column].range; }
  std::size_t size() const { return columns_.size(); }

  // Both go through the particles once, by blocks that all threads of the run share.
  void measure() {
    const std::size_t blocks = block_count(selected_.size(), coded_at_a_time);
    gathered_.resize(std::max(gathered_.size(), columns_.size()));
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      columns_[c].ranges.assign(blocks, {});
      gathered_[c].resize(selected_.size());
    }
    parallel_blocks(selected_.size(), coded_at_a_time, [&](std::size_t block, std::size_t first, std::size_t last) {
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        Column& column = columns_[c];
        const double* const values = read(column, first, last, gathered_[c].data() + first);
        column.ranges[block] = range_of(values, last - first);
        if (first == 0) column.values = values;  // the source, or what was gathered of it
      }
    });
    for (Column& column : columns_) {
      for (const CodeRange& range : column.ranges) column.range.join(range);
      column.range = column.range.known();
    }
  }
  void write() {
    parallel_blocks(selected_.size(), coded_at_a_time, [&](std::size_t, std::size_t first, std::size_t last) {
      for (const Column& column : columns_) {
        const std::size_t place = first * column.stride + column.offset;
        const double* const values = column.values + first;
        if (column.bits == 8)
          write_codes(values, last - first, column.range, column.top, column.odd,
                      payload_.codes<std::uint8_t>(column.at) + place, column.stride);
        else
          write_codes(values, last - first, column.range, column.top, column.odd,
                      payload_.codes<std::uint16_t>(column.at) + place, column.stride);
      }
    });
  }

 private:
  struct Column {
    const ParticleField* field;
    int component;
    std::size_t at, offset, stride;
    int bits, top, odd;
    CodeRange range;
    std::vector<CodeRange> ranges;
    const double* values;
  };
  const double* read(const Column& column, std::size_t first, std::size_t last, double* buffer) const {
    return column.field->f64.empty() ? selected_.read(column.field->i64, column.component, first, last, buffer)
                                     : selected_.read(column.field->f64, column.component, first, last, buffer);
  }
  const Selection& selected_;
  Payload& payload_;
  std::vector<std::vector<double>>& gathered_;
  std::vector<Column> columns_;
};

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

const ParticleField& filled(const ParticleField& field) {
  if (field.compute) field.compute();
  return field;
}

// Diameters of the particles, where the family has them; or their radii.
const ParticleField* size_field(const ParticleSnapshot& family) {
  for (const ParticleField& field : family.fields)
    if ((field.name == "radius" || field.name == "diameter") && field.f64.size() == 1) return &field;
  return nullptr;
}

const ParticleField* phase_field(const ParticleSnapshot& family) {
  for (const ParticleField& field : family.fields)
    if (field.name == "phase" && field.i64.size() == 1) return &field;
  return nullptr;
}

nlohmann::json particle_block(const ParticleSnapshot& family, std::size_t most, const FrameWish& wish, Payload& payload,
                              FrameScratch& scratch) {
  const std::vector<Colouring> list = all_colourings(family);
  const Colouring* const colour = chosen(list, family.name, wish);
  nlohmann::json block = new_block("particles", family, list, colour);
  const Selection selected(family, most, scratch);
  const std::size_t count = selected.size(), dimensions = family.position.size();
  block["dimensions"] = dimensions;
  block["total"] = family.size;
  block["count"] = count;
  CodeColumns columns(selected, payload, scratch);

  // A step that leaves a particle at no finite place is refused, so that nothing stands for one.
  const ParticleField position{"position", family.position, {}};
  const std::size_t places = payload.add(count * dimensions * 2);
  for (std::size_t axis = 0; axis < dimensions; ++axis)
    columns.add(position, static_cast<int>(axis), places, axis, dimensions, 16, 65535, 0);
  block["positions"] = {{"at", places}};
  const std::size_t coloured = columns.size();
  if (colour != nullptr) {
    const std::size_t at = payload.add(count * static_cast<std::size_t>(wish.bits / 8));
    const int top = wish.bits == 8 ? 254 : 65534;
    columns.add(filled(family.fields[colour->field]), colour->component, at, 0, 1, wish.bits, top, top + 1);
    block["values"] = {{"at", at}, {"bits", wish.bits}};
  }
  const std::size_t sized = columns.size();
  const ParticleField* const size = size_field(family);
  if (size != nullptr) {
    const std::size_t at = payload.add(count * 2);
    columns.add(filled(*size), 0, at, 0, 1, 16, 65534, 65535);
    block["sizes"] = {{"at", at}};
  }
  const std::size_t phased = columns.size();
  const ParticleField* const phase = wish.phases ? phase_field(family) : nullptr;
  if (phase != nullptr) {
    const std::size_t at = payload.add(count);
    columns.add(*phase, 0, at, 0, 1, 8, 255, 255);
    block["phases"] = {{"at", at}};
  }

  columns.measure();
  for (std::size_t axis = 0; axis < dimensions; ++axis) {
    block["lower"].push_back(columns.range(axis).low);
    block["upper"].push_back(columns.range(axis).high);
  }
  if (colour != nullptr) {
    block["values"]["low"] = columns.range(coloured).low;
    block["values"]["high"] = columns.range(coloured).high;
  }
  if (size != nullptr) {
    CodeRange& sizes = columns.range(sized);
    sizes = {0, std::max(0.0, sizes.high)};
    block["sizes"]["largest"] = (size->name == "radius" ? 2 : 1) * sizes.high;
  }
  if (phase != nullptr) columns.range(phased) = {0, 255};  // the codes are the numbers
  columns.write();
  return block;
}

std::size_t number_of(const GridSnapshot& grid, const std::array<std::size_t, 3>& point) {
  return (point[0] * grid.points[1] + point[1]) * grid.points[2] + point[2];
}

double value_at(const std::vector<const float*>& components, int component, std::size_t i) {
  if (component >= 0) return static_cast<double>(components[static_cast<std::size_t>(component)][i]);
  double squares = 0;
  for (const float* one : components) squares += static_cast<double>(one[i]) * static_cast<double>(one[i]);
  return std::sqrt(squares);
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
  parallel_for(values.size(), [&](std::size_t k) {
    std::array<std::size_t, 3> point{};
    point[across] = k % columns * skip_across;
    point[along] = k / columns * skip_along;
    point[normal] = layer;
    values[k] = value_at(components, colour->component, number_of(grid, point));
  });
  add_values(block, payload, values.data(), values.size(), wish.bits);
  return block;
}

// The field as a whole, thinned alike along all axes: the page finds surfaces of equal value in it.
nlohmann::json volume_block(const GridSnapshot& grid, const FrameWish& wish, Payload& payload, FrameScratch& scratch) {
  const std::vector<Colouring> list = all_colourings(grid);
  const Colouring* const colour = chosen(list, grid.name, wish);
  nlohmann::json block = new_block("volume", grid, list, colour);
  const std::size_t longest = *std::max_element(grid.points.begin(), grid.points.end());
  const std::size_t skip = (longest + wish.volume - 1) / wish.volume;
  std::array<std::size_t, 3> points{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    points[axis] = (grid.points[axis] + skip - 1) / skip;
    block["spacing"].push_back(grid.spacing[axis] * static_cast<double>(skip));
    // The last of every so many points is followed by the first one at the same distance, or by nothing.
    block["wraps"].push_back(grid.periodic && grid.points[axis] % skip == 0);
  }
  block["lower"] = grid.origin;
  block["points"] = points;
  if (colour == nullptr) return block;
  const auto& components = grid.fields[colour->field].components;
  std::vector<double>& values = scratch.values;
  values.resize(points[0] * points[1] * points[2]);
  parallel_for(values.size(), [&](std::size_t k) {
    const std::array<std::size_t, 3> point{k / points[2] / points[1] * skip, k / points[2] % points[1] * skip,
                                           k % points[2] * skip};
    values[k] = value_at(components, colour->component, number_of(grid, point));
  });
  add_values(block, payload, values.data(), values.size(), wish.bits);
  return block;
}

}  // namespace

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
                                                    const std::vector<GridSnapshot>& grids, const FrameWish& wish,
                                                    double spacing) {
  return make(step, {{time, families, grids, spacing}}, wish);
}

std::shared_ptr<const std::string> FrameMaker::make(std::int64_t step, const std::vector<FrameSide>& sides,
                                                    const FrameWish& wish) {
  const std::shared_ptr<std::string> frame = free_buffer();
  Payload payload(*frame);
  nlohmann::json header{{"step", step}, {"time", sides.front().time}, {"blocks", nlohmann::json::array()}};
  for (std::size_t side = 0; side < sides.size(); ++side) {
    const FrameSide& shown = sides[side];
    const auto add = [&](nlohmann::json block) {
      if (sides.size() > 1) block["side"] = side;
      header["blocks"].push_back(std::move(block));
    };
    for (const GridSnapshot& grid : shown.grids) {
      add(plane_block(grid, wish, payload, scratch_));
      if (wish.volume > 0) add(volume_block(grid, wish, payload, scratch_));
    }
    // A family with less than its share leaves the rest to those that come after it in size.
    std::vector<const ParticleSnapshot*> by_size;
    by_size.reserve(shown.families.size());
    for (const ParticleSnapshot& family : shown.families) by_size.push_back(&family);
    std::sort(by_size.begin(), by_size.end(), [](const auto* a, const auto* b) { return a->size < b->size; });
    std::size_t left = std::min(wish.points, most_frame_points) / sides.size();
    std::map<const ParticleSnapshot*, std::size_t> shares;
    for (std::size_t k = 0; k < by_size.size(); ++k) {
      shares[by_size[k]] = std::min(by_size[k]->size, left / (by_size.size() - k));
      left -= shares[by_size[k]];
    }
    for (const ParticleSnapshot& family : shown.families)
      add(particle_block(family, shares[&family], wish, payload, scratch_));
    if (side > 0) {
      header["beside"] = {{"time", shown.time}};
      continue;
    }
    if (wish.picked) header["picked"] = picked_particle(shown.families, *wish.picked);
    if (wish.point) header["point"] = values_at(shown, *wish.point);
  }
  payload.finish(header);
  return frame;
}

}  // namespace spume
