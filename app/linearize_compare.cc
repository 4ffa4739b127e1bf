#include "app/linearize_compare.h"

#include <algorithm>

#include "app/format.h"
#include "mjdiag/plugin/plant/transition.h"
#include "mjdiag/plugin/setup/chain_file.h"
#include "mjdiag/plugin/setup/published_relation_file.h"
#include "mjdiag/signals/error.h"

namespace mjdiag::app {
namespace {

// Agreement that the two models are held to, relative Frobenius norms.
constexpr double kMatrixTolerance = 1e-9;
constexpr double kTickTolerance = 1e-8;
// One unit in the last printed digit.
constexpr double kPrintedHalfUlps = 2.0;

double RelativeDifference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const double scale = b.norm();
  return scale > 0.0 ? (a - b).norm() / scale : a.norm();
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

double TickDifference(const Machine& machine) {
  const Rates& rates = machine.rates();
  const StateSpace exact = TickModel(machine.linear(), rates.step(), rates.substeps);
  const StateSpace differences =
      TransitionAbout(machine.plant(), machine.channels(),
                      HeldAt(machine.plant(), machine.channels(), machine.rest_pose()),
                      rates.substeps)
          .tick;
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

}  // namespace

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

}  // namespace mjdiag::app
