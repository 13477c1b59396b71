#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/fuzzy/membership.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::fuzzy {

/// The most terms a variable may have. Inference works in arrays of this size, so that it never allocates.
inline constexpr std::size_t kMaxTerms = 16;

/// A linguistic term: a label such as "NB" (negative big) and its fuzzy set.
struct Term {
  std::string label;       ///< its name, e.g. NS
  MembershipFunction set;  ///< Triangle, Trapezoid or Gaussian
};

/// A linguistic variable: a name, its universe of discourse and its terms, from negative to positive.
struct LinguisticVariable {
  std::string name;         ///< name of the variable, e.g. E
  double min = -1.0;        ///< lower end of the universe
  double max = 1.0;         ///< upper end of the universe
  std::vector<Term> terms;  ///< list of Term from negative to positive, a copy

  /// The value the controller works with: inputs outside the universe saturate at its ends; NaN stays NaN.
  double saturate(double x) const noexcept { return x < min ? min : (x > max ? max : x); }
  /// Index of a label; throws std::invalid_argument listing the existing labels:
  /// "'XX' is not a term of U; terms: NB, NM, NS, ZE, PS, PM, PB".
  std::size_t index_of(const std::string& label) const;
};

/// A controller that fails validation, and where: `where` is the place in the file ("E.terms.NB", "rules.NB.PS").
class ValidationError : public std::invalid_argument {
 public:
  /// `where`: the variable, term or cell at fault.
  ValidationError(std::string where, const std::string& problem)
      : std::invalid_argument(where + ": " + problem), where_(std::move(where)), problem_(problem) {}
  const std::string& where() const { return where_; }      ///< the variable, term or cell at fault
  const std::string& problem() const { return problem_; }  ///< what is wrong with it

 private:
  std::string where_, problem_;
};

/// Throws ValidationError unless the universe is a finite interval and there are 1 to kMaxTerms terms, all labels
/// different, all sets well formed.
void validate(const LinguisticVariable& variable);

}  // namespace pilotfish::fuzzy
PILOTFISH_API_END
