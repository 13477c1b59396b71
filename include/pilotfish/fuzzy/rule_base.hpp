#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/fuzzy/linguistic_variable.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::fuzzy {

/// A complete table of rules "IF E is row AND EC is column THEN U is cell" (the paper's Table I), stored row by row.
/// Here it is 8 x 7, no other: status_t carries 56 firing strengths, Inference and the plan are arrays of that size, so
/// validate() refuses a table of another size. `rows` and `columns` are those of the file, for that error message.
struct RuleBase {
  std::size_t rows = 0;                  ///< number of terms of E
  std::size_t columns = 0;               ///< number of terms of EC
  std::vector<std::size_t> consequents;  ///< index of the output term, [row * columns + column]

  std::size_t size() const { return consequents.size(); }  ///< number of rules
  /// Index of the output term of a cell.
  std::size_t consequent(std::size_t row, std::size_t column) const { return consequents[row * columns + column]; }
};

/// The paper's numbers: 8 terms of E x 7 terms of EC.
inline constexpr std::size_t kPaperRows = 8;
inline constexpr std::size_t kPaperColumns = 7;
inline constexpr std::size_t kPaperRules = kPaperRows * kPaperColumns;

struct Plan;  // src/fuzzy/plan.hpp

/// A two-input Mamdani controller as plain data: the content of data/fuzzy/*.yaml.
struct Controller {
  std::string name;                 ///< name of the controller, for people
  LinguisticVariable error;         ///< E, of the normalised distance error
  LinguisticVariable error_change;  ///< EC, of its normalised change per control period
  LinguisticVariable output;        ///< U, of the normalised velocity
  RuleBase rules;                   ///< the paper's Table I by default
  /// Precomputed for inference by validate() from the data above: validate again after changing them.
  std::shared_ptr<const Plan> plan = nullptr;
};

/// "IF E is NS AND EC is ZE THEN U is PM"; rule = row * columns + column. Throws std::out_of_range.
std::string describe_rule(const Controller& controller, std::size_t rule);

/// The weakest degree that still counts as covering a point of an input universe.
inline constexpr double kMinCoverage = 1e-3;

/// Validates what the control loop relies on, so that inference cannot fail later, and prepares controller.plan, so
/// that it is fast and never allocates. Throws ValidationError naming the variable, the term or the cell that is at
/// fault:
///  - the rule base has exactly kPaperRows x kPaperColumns cells, each with a term of U;
///  - every universe is finite, every label unique, every membership function well formed, and no variable
///  has more
///    than kMaxTerms terms;
///  - every point of both input universes has a term of a degree above kMinCoverage, so some rule fires for
///  every input;
///  - every term has area inside its universe: so every rule can fire, and the centroid's denominator is
///  positive;
///  - the output is finite and inside U's universe over the grid of the corner points of all input sets.
void validate(Controller& controller);

}  // namespace pilotfish::fuzzy
PILOTFISH_API_END
