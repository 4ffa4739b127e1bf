#include "mjdiag/report/discovery_json.h"

#include "mjdiag/report/discovery_fields.h"
#include "mjdiag/report/fields_json.h"

namespace mjdiag {

nlohmann::json ToJson(const Discovery& discovery, const std::string& extended_plant) {
  nlohmann::json document = JsonOf(discovery);
  document["extended_plant"] = JsonOf(TextOrNone(extended_plant));
  return document;
}

}  // namespace mjdiag
