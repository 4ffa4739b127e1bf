// Plans from what Python has them in.

#include <filesystem>
#include <utility>

#include "mjdiag/signals/error.h"
#include "python/arrays.h"
#include "python/machine_source.h"
#include "python/record.h"
#include "python/study.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

std::string Quoted(py::handle text) { return TomlText("plan", py::str(text)); }

/// Keys of a dict may have dots in them, as those of `set`.
std::string PlanText(const std::string& key, py::handle value) {
  if (py::isinstance<py::dict>(value)) {
    std::string text;
    for (const auto& [name, item] : py::reinterpret_borrow<py::dict>(value)) {
      text += (text.empty() ? "" : ", ") + Quoted(name) + " = " +
              PlanText(key + "." + std::string(py::str(name)), item);
    }
    return "{ " + text + " }";
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    std::string text;
    for (const py::handle item : value) {
      text += (text.empty() ? "" : ", ") + PlanText(key, item);
    }
    return "[" + text + "]";
  }
  return TomlText(key, value);
}

/// One key a line, so that complaints have a line to name.
std::string PlanOfDict(const py::dict& plan) {
  std::string text;
  for (const auto& [name, value] : plan) {
    text += Quoted(name) + " = " + PlanText(std::string(py::str(name)), value) + "\n";
  }
  return text;
}

bool IsTomlText(const py::object& plan) {
  return py::isinstance<py::str>(plan) &&
         py::cast<std::string>(plan).find('\n') != std::string::npos;
}

}  // namespace

StudyObject StudyOf(const py::object& plan) {
  const std::filesystem::path here = std::filesystem::current_path();
  std::shared_ptr<const LoadedPlan> loaded;
  if (py::isinstance<py::dict>(plan)) {
    const py::dict values(plan);
    std::string text;
    if (!values.contains("schema")) text = "schema = \"mjdiag.plan/1\"\n";
    if (!values.contains("name")) text += "name = \"study\"\n";
    loaded = std::make_shared<LoadedPlan>(ParsePlan(text + PlanOfDict(values), here));
  } else if (IsTomlText(plan)) {
    loaded = std::make_shared<LoadedPlan>(ParsePlan(py::cast<std::string>(plan), here));
  } else if (IsPath(plan)) {
    loaded = std::make_shared<LoadedPlan>(ReadPlan(PathOf(plan, "Study")));
  } else {
    throw InputError("Study", KindOf(plan),
                     "a plan: its path, its TOML, or a dict with the same keys");
  }
  auto planner = std::make_shared<RunPlanner>(loaded->plan);
  return {std::move(loaded), std::move(planner)};
}

}  // namespace mjdiag::python
