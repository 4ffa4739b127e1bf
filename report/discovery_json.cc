#include "mjdiag/report/discovery_json.h"

#include "mjdiag/report/discovery_fields.h"
#include "mjdiag/signals/fields_json.h"

namespace mjdiag {

nlohmann::json ToJson(const Discovery& discovery, const std::string& extended_plant) {
  nlohmann::json document = JsonOf(discovery);
  if (!extended_plant.empty()) document["extended_plant"] = extended_plant;
  return document;
}

}  // namespace mjdiag
