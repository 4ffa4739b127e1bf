#include "mjdiag/plugin/setup/chain_file.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/setup/toml_table.h"

namespace mjdiag {
namespace {

constexpr const char* kChainSchema = "mjdiag.linear_chain/1";

/// True for `yes`, false for `no`.
bool ReadType(const TomlTable& table, const std::string& yes, const std::string& no) {
  const std::string type = table.Text("type");
  if (type != yes && type != no) {
    table.Fail("type", "is \"" + type + "\"", "\"" + no + "\" or \"" + yes + "\"");
  }
  return type == yes;
}

Eigen::Vector3d ReadVector(const TomlTable& table, std::string_view key,
                           const NumberRule& rule = kAnyNumber) {
  const std::vector<double> numbers = table.Numbers(key, rule);
  if (numbers.size() != 3) {
    table.Fail(key, "holds " + std::to_string(numbers.size()) + " numbers",
               "three: x, y, z");
  }
  return {numbers[0], numbers[1], numbers[2]};
}

Eigen::Vector3d ReadDirection(const TomlTable& table) {
  Eigen::Vector3d axis = ReadVector(table, "axis");
  if (std::abs(axis.norm() - 1.0) > 1e-12) {
    table.Fail("axis", "is not of unit length", "a unit vector");
  }
  return axis;
}

/// The name of a body that has been read, or empty, for the world, without the key.
std::string ReadBodyName(const TomlTable& table, std::string_view key,
                         const LinearChain& chain) {
  if (!table.Has(key)) return "";
  std::string name = table.Text(key);
  const bool known =
      std::any_of(chain.bodies.begin(), chain.bodies.end(),
                  [&](const ChainBody& body) { return body.name == name; });
  if (!known) {
    table.Fail(key, "no body is called '" + name + "'", "a body that stands before");
  }
  return name;
}

ChainJoint ReadJoint(const TomlTable& table) {
  ChainJoint joint;
  joint.name = table.Text("name");
  joint.hinge = ReadType(table, "hinge", "slide");
  joint.axis = ReadDirection(table);
  if (joint.hinge) joint.point = ReadVector(table, "point");
  joint.stiffness = table.Number("stiffness", kAnyNumber, 0.0);
  joint.damping = table.Number("damping", kNonNegative, 0.0);
  return joint;
}

ChainBody ReadBody(const TomlTable& table, const LinearChain& chain) {
  ChainBody body;
  body.name = table.Text("name");
  body.parent = ReadBodyName(table, "parent", chain);
  body.mass = table.Number("mass", kNonNegative);
  body.centre = ReadVector(table, "centre");
  body.inertia = ReadVector(table, "inertia", kNonNegative);
  for (const TomlTable& joint : table.TableArray("joints")) {
    body.joints.push_back(ReadJoint(joint));
  }
  return body;
}

ChainPort ReadPort(const TomlTable& table, const LinearChain& chain) {
  ChainPort port;
  port.name = table.Text("name");
  port.body = ReadBodyName(table, "body", chain);
  port.base = ReadBodyName(table, "base", chain);
  port.rotational = ReadType(table, "rotational", "linear");
  port.axis = ReadDirection(table);
  if (!port.rotational) port.point = ReadVector(table, "point");
  port.gain = table.Number("gain", kNonZero, 1.0);
  return port;
}

}  // namespace

LinearChain ReadLinearChain(const std::filesystem::path& file) {
  const TomlDocument document(file, {});
  const TomlTable root = document.Root();
  root.RequireSchema(kChainSchema);
  LinearChain chain;
  chain.gravity = root.Number("gravity", kAnyNumber, chain.gravity);
  for (const TomlTable& body : root.TableArray("bodies")) {
    chain.bodies.push_back(ReadBody(body, chain));
  }
  for (const TomlTable& actuator : root.TableArray("actuators")) {
    chain.actuators.push_back(ReadPort(actuator, chain));
  }
  for (const TomlTable& sensor : root.TableArray("sensors")) {
    chain.sensors.push_back(ReadPort(sensor, chain));
  }
  document.RefuseUnknownKeys();
  return chain;
}

}  // namespace mjdiag
