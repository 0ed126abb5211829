// SPDX-License-Identifier: MIT
// Groups of options by their type: what a method adds to a case without the case knowing the method.
#pragma once

#include <any>
#include <map>
#include <stdexcept>
#include <string>
#include <typeindex>
#include <utility>

namespace spume {

class OptionGroups {
 public:
  // Makes the group with the defaults of its type; one that is there already keeps its values.
  template <class T>
  void declare() {
    groups_.try_emplace(typeid(T), T{});
  }

  // Throws std::logic_error when the method of the case has not declared the group. A search by type: loops over
  // particles keep the reference.
  template <class T>
  const T& get() const {
    const auto found = groups_.find(typeid(T));
    if (found == groups_.end())
      throw std::logic_error(std::string("the method of this case declares no options of type ") + typeid(T).name());
    return *std::any_cast<T>(&found->second);
  }
  // Null when the method has not declared the group.
  template <class T>
  const T* find() const {
    const auto found = groups_.find(typeid(T));
    return found == groups_.end() ? nullptr : std::any_cast<T>(&found->second);
  }
  template <class T>
  T& get() {
    return const_cast<T&>(std::as_const(*this).template get<T>());
  }

 private:
  std::map<std::type_index, std::any> groups_;
};

}  // namespace spume
