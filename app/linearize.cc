// mjdiag linearize: the linear equations of motion of a machine.

#include "mjdiag/plugin/plant/linearize.h"

#include <Eigen/Core>
#include <memory>

#include "app/command.h"
#include "app/exit_status.h"
#include "app/format.h"
#include "app/output.h"
#include "app/subject.h"
#include "mjdiag/diagnosis/json_matrix.h"
#include "mjdiag/plugin/plant/transition.h"
#include "mjdiag/plugin/runtime/closed_loop.h"
#include "mjdiag/plugin/setup/chain_file.h"
#include "mjdiag/plugin/setup/published_relation_file.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag::app {
namespace {

struct LinearizeOptions {
  MachineOptions machine;
  OutputOptions output;
  bool compare = false;
  bool published = false;
};

// Agreement that the two models are held to, relative Frobenius norms.
constexpr double kMatrixTolerance = 1e-9;
constexpr double kTickTolerance = 1e-8;
// One unit in the last printed digit.
constexpr double kPrintedHalfUlps = 2.0;

double RelativeDifference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const double scale = b.norm();
  return scale > 0.0 ? (a - b).norm() / scale : a.norm();
}

nlohmann::json ModelJson(const MechanicalModel& model) {
  nlohmann::json modes = nlohmann::json::array();
  for (const Mode& mode : Modes(model)) {
    modes.push_back(
        {{"frequency", mode.frequency}, {"damping_ratio", mode.damping_ratio}});
  }
  return {{"coordinates", model.coordinates},
          {"inputs", model.inputs},
          {"outputs", model.outputs},
          {"M", MatrixJson(model.M)},
          {"D", MatrixJson(model.D)},
          {"K", MatrixJson(model.K)},
          {"Gamma", MatrixJson(model.Gamma)},
          {"b", MatrixJson(model.b)},
          {"modes", modes}};
}

/// The joint that moves most in a mode, in energy: unlike amplitudes, energies of
/// slides and hinges compare.
std::string Dominant(const MechanicalModel& model, const Mode& mode) {
  Eigen::Index joint = 0;
  (mode.shape.array().square() * model.M.diagonal().array()).maxCoeff(&joint);
  return model.coordinates[static_cast<std::size_t>(joint)];
}

std::string ModeTable(const MechanicalModel& model) {
  Table table({"mode", "frequency", "damping ratio", "moves most"});
  int number = 0;
  for (const Mode& mode : Modes(model)) {
    table.Add({std::to_string(++number), FormatQuantity(mode.frequency, "Hz"),
               Short(mode.damping_ratio), Dominant(model, mode)});
  }
  return table.ToString();
}

void AddMatrixRows(Table& table, const std::string& symbol,
                   const std::vector<std::string>& rows,
                   const std::vector<std::string>& columns,
                   const Eigen::MatrixXd& extracted, const Eigen::MatrixXd& analytic) {
  const double negligible = 1e-12 * analytic.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < extracted.rows(); ++i) {
    for (Eigen::Index j = 0; j < extracted.cols(); ++j) {
      const double a = extracted(i, j);
      const double b = analytic(i, j);
      const bool mirrored = symbol.size() == 1 && symbol != "b" && j < i;
      if (mirrored || (std::abs(a) <= negligible && std::abs(b) <= negligible))
        continue;
      table.Add({symbol + "(" + rows[static_cast<std::size_t>(i)] + ", " +
                     columns[static_cast<std::size_t>(j)] + ")",
                 Short(a), Short(b), Short(a - b)});
    }
  }
}

std::string SideBySide(const MechanicalModel& extracted,
                       const MechanicalModel& analytic) {
  Table table({"entry", "MuJoCo", "analytic", "difference"});
  const auto& q = extracted.coordinates;
  AddMatrixRows(table, "M", q, q, extracted.M, analytic.M);
  AddMatrixRows(table, "D", q, q, extracted.D, analytic.D);
  AddMatrixRows(table, "K", q, q, extracted.K, analytic.K);
  AddMatrixRows(table, "Gamma", q, extracted.inputs, extracted.Gamma, analytic.Gamma);
  AddMatrixRows(table, "b", q, extracted.outputs, extracted.b, analytic.b);
  return table.ToString();
}

StateSpace Tick(const Machine& machine) {
  const Rates& rates = machine.rates();
  return TickModel(machine.linear(), rates.step(), rates.substeps);
}

double TickDifference(const Machine& machine) {
  const StateSpace exact = Tick(machine);
  const StateSpace differences = TickByFiniteDifferences(
      machine.plant(), machine.channels(), machine.rates().substeps);
  return std::max({RelativeDifference(exact.A, differences.A),
                   RelativeDifference(exact.B, differences.B),
                   RelativeDifference(exact.C, differences.C)});
}

void RequireSameChannels(const MechanicalModel& extracted,
                         const MechanicalModel& analytic, const std::string& file) {
  if (extracted.coordinates != analytic.coordinates ||
      extracted.inputs != analytic.inputs || extracted.outputs != analytic.outputs) {
    throw InputError(file, "joints, actuators or sensors differ from the plant's",
                     "the same names in the same order");
  }
}

struct Answer {
  std::string text;
  bool good = true;
};

Answer CompareWithAnalytic(const Machine& machine, nlohmann::json& document) {
  const MechanicalModel& extracted = machine.linear();
  if (!machine.setup().analytic) {
    throw InputError("--compare", "the setup has no analytic model",
                     "a key 'analytic' in setup.toml");
  }
  const MechanicalModel analytic =
      Linearize(ReadLinearChain(*machine.setup().analytic));
  RequireSameChannels(extracted, analytic, machine.setup().analytic->string());
  const nlohmann::json difference = {
      {"M", RelativeDifference(extracted.M, analytic.M)},
      {"D", RelativeDifference(extracted.D, analytic.D)},
      {"K", RelativeDifference(extracted.K, analytic.K)},
      {"Gamma", RelativeDifference(extracted.Gamma, analytic.Gamma)},
      {"b", RelativeDifference(extracted.b, analytic.b)},
      {"tick", TickDifference(machine)}};
  document["difference"] = difference;

  Answer answer;
  answer.text = SideBySide(extracted, analytic) + "\n";
  Table table({"matrix", "relative difference", "at most"});
  for (const auto& [name, value] : difference.items()) {
    const double limit = name == "tick" ? kTickTolerance : kMatrixTolerance;
    table.Add({name, Short(value), Short(limit)});
    answer.good = answer.good && value.get<double>() <= limit;
  }
  answer.text += table.ToString() +
                 "tick: the exact discrete map of a control tick against "
                 "mjd_transitionFD\n";
  return answer;
}

Answer ComparePublished(const Machine& machine, nlohmann::json& document) {
  if (!machine.setup().published) {
    throw InputError("--published", "the setup has no published parity relation",
                     "a key 'published' in setup.toml");
  }
  const PublishedRelationComparison comparison = ComparePublishedRelation(
      machine.linear(), ReadPublishedRelation(*machine.setup().published));
  nlohmann::json coefficients = nlohmann::json::array();
  Table table({"coefficient", "printed", "computed", "half units of the last digit"});
  for (const CoefficientComparison& c : comparison.coefficients) {
    coefficients.push_back({{"channel", c.channel},
                            {"power", c.power},
                            {"printed", c.printed},
                            {"computed", c.computed}});
    table.Add({c.channel + " s^" + std::to_string(c.power), Short(c.printed),
               Short(c.computed), Short(c.half_ulps)});
  }
  document["published"] = {{"worst_half_ulp", comparison.worst_half_ulp},
                           {"coefficients", coefficients}};
  return {table.ToString() + "worst of " +
              std::to_string(comparison.coefficients.size()) +
              " coefficients: " + Short(comparison.worst_half_ulp) +
              " half units of the last printed digit\n",
          comparison.worst_half_ulp <= kPrintedHalfUlps};
}

void Linearize(const LinearizeOptions& options) {
  const Subject subject = LoadSubject(options.machine);
  const Machine& machine = subject.machine;
  if (!machine.changes().effects.empty() || !subject.options.disturbances.empty() ||
      !subject.options.late_faults.empty()) {
    throw InputError("linearize",
                     "effects, disturbances and late faults are not linear",
                     "fault parameters of the plant only");
  }
  const MechanicalModel& extracted = machine.linear();

  nlohmann::json document = ModelJson(extracted);
  document.update(ToJson(subject));
  document["schema"] = "mjdiag.linearize/1";
  document["command"] = CommandLine();
  document["setup"] = machine.setup().name;
  std::string text =
      machine.setup().name + ", " + Describe(subject) + "\n\n" + ModeTable(extracted);
  if (!machine.setup().control.axes.empty()) {
    const double radius =
        SpectralRadius(ClosedLoopMatrix(Tick(machine), machine.setup()));
    document["closed_loop"] = {{"largest_eigenvalue", radius}};
    text += "\nclosed loop: largest eigenvalue " + Short(radius) +
            (radius < 1.0 ? ", stable\n" : ", unstable\n");
  }
  bool good = true;
  for (const auto& [wanted, compare] :
       {std::pair{options.compare, &CompareWithAnalytic},
        std::pair{options.published, &ComparePublished}}) {
    if (!wanted) continue;
    const Answer answer = compare(machine, document);
    text += "\n" + answer.text;
    good = good && answer.good;
  }
  PrepareOutput(options.output);
  Publish(options.output, "linearize", document, text);
  if (!good) throw NegativeAnswer();
}

}  // namespace

void AddLinearize(CLI::App& app) {
  auto options = std::make_shared<LinearizeOptions>();
  CLI::App* command = app.add_subcommand(
      "linearize", "M, D, K, Gamma, b and the modes about the static equilibrium");
  AddMachineOptions(*command, options->machine);
  AddOutputOptions(*command, options->output, false);
  command->add_flag(
      "--compare", options->compare,
      "Against the setup's analytic model and MuJoCo's finite differences; "
      "exit status 1 if they differ by more than 1e-9, 1e-8");
  command->add_flag("--published", options->published,
                    "Against the setup's published parity relation; exit status 1 if a "
                    "coefficient differs by more than a unit of its last digit");
  command->callback([options] { Linearize(*options); });
}

}  // namespace mjdiag::app
