// SPDX-License-Identifier: MIT
// The output fields of a particle method, declared once: the registration takes from the table what a case may name,
// the method what its snapshots hold.
//
//   const std::vector<OutputField<Flow>> fields{
//       {"velocity", always, [](const Flow& flow) { return flow.particles.velocity; }},
//       {"eddy_viscosity", on_request, [](const Flow& flow, std::size_t i) { return flow.eddy_viscosity_of(i); },
//        {has_closure, "a turbulence.model"}}};
#pragma once

#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "spume/particles/reports.hpp"
#include "spume/scene/method_declaration.hpp"

namespace spume {

using CaseCondition = bool (*)(const Case&);

// Whether a field is written although the case lists none.
inline bool always(const Case&) {
  return true;
}
inline bool on_request(const Case&) {
  return false;
}

// What a case must have for a field to exist.
struct FieldNeed {
  CaseCondition met = always;
  const char* in_words = "";
};

template <class State>
class OutputField {
 public:
  // `read` gives a VectorField, a FloatVectorField or a pointer to an Array<double> or Array<std::int64_t>, [](const
  // State&), or the value of particle i, [](const State&, std::size_t i).
  template <class Read>
  OutputField(std::string name, CaseCondition standard, Read read, FieldNeed need = {})
      : name_(std::move(name)), standard_(standard), need_(need) {
    add_ = [read](SnapshotTable& table, const std::string& field, bool written, const State& state) {
      if constexpr (std::is_invocable_v<Read, const State&, std::size_t>)
        table.add(field, written, [read, &state](std::size_t i) { return static_cast<double>(read(state, i)); });
      else if constexpr (std::is_pointer_v<std::invoke_result_t<Read, const State&>>)
        table.add(field, written, *read(state));
      else
        table.add(field, written, read(state));
    };
  }

  OutputFieldInfo info(const Case& options) const { return {name_, need_.met(options) ? "" : need_.in_words}; }
  void add_to(SnapshotTable& table, const Case& options, const State& state) const {
    if (need_.met(options)) add_(table, name_, standard_(options), state);
  }

 private:
  std::string name_;
  CaseCondition standard_;
  FieldNeed need_;
  std::function<void(SnapshotTable&, const std::string&, bool, const State&)> add_;
};

// For MethodDeclaration::output_fields.
template <class State>
std::vector<OutputFieldInfo> field_infos(const std::vector<OutputField<State>>& fields, const Case& options) {
  std::vector<OutputFieldInfo> infos;
  infos.reserve(fields.size());
  for (const OutputField<State>& field : fields) infos.push_back(field.info(options));
  return infos;
}

// The fields that the case has, read from `state`, which outlives the table.
template <class State>
SnapshotTable snapshot_table(const std::vector<OutputField<State>>& fields, const Case& options, const State& state) {
  SnapshotTable table;
  for (const OutputField<State>& field : fields) field.add_to(table, options, state);
  return table;
}

}  // namespace spume
