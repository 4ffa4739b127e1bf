#pragma once
// What the JSON document of a result has, a line each in the order of its description
// (fields.h): "channels.<name>.rms [unit]: Root of the mean square."

#include <functional>
#include <string>
#include <type_traits>

#include "mjdiag/signals/fields.h"

namespace mjdiag {

/// @param path  of the value in the document
template <typename Value>
std::string FieldReferenceAt(const std::string& path) {
  std::string lines;
  if constexpr (kHasFields<Value>) {
    ForEachField<Value>([&](const auto& field) {
      if constexpr (std::decay_t<decltype(field)>::kIsInJson) {
        using Figure = std::invoke_result_t<decltype(field.get), const Value&>;
        const std::string name = path + (path.empty() ? "" : ".") + field.name;
        const std::string unit = field.unit;
        lines += name + (unit.empty() ? "" : " [" + unit + "]") + ": " + field.text +
                 "\n" + FieldReferenceAt<std::decay_t<Figure>>(name);
      }
    });
  } else if constexpr (kIsNamed<Value>) {
    lines = FieldReferenceAt<typename Value::value_type::second_type>(path + ".<name>");
  } else if constexpr (requires(Value value) { value.has_value(); }) {
    lines = FieldReferenceAt<typename Value::value_type>(path);
  } else if constexpr (requires { typename Value::value_type; }) {
    lines = FieldReferenceAt<typename Value::value_type>(path + "[]");
  }
  return lines;
}

template <typename Result>
std::string FieldReference() {
  return FieldReferenceAt<Result>("");
}

}  // namespace mjdiag
