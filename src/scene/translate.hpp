// SPDX-License-Identifier: MIT
// A case that the command line gives to another method, in the words which that method takes.
#pragma once

#include <string>
#include <vector>

#include "spume/scene/case_schema.hpp"

namespace spume {

struct Translation {
  std::vector<Problem> warnings;  // what the method does without, at its place
  bool groups = false;            // phases were made of groups: their values are no SI values
};

// Rewrites the document of a case whose method is an override, where it differs in words alone:
//
//   [fluid] and [[liquid]]      as [[phase]] "liquid" and [[region]], for a method that fills phases;
//                               reynolds: viscosity 1/Re at density 1
//   one [[phase]], [[region]]   as [fluid] and [[liquid]], for a method of one liquid; beside a Froude number
//                               reynolds is 1/viscosity at density 1, and gravity 1/Fr^2 at any other
//   [[solid]]                   as [[body]], for a method that has no boxes; faces on a side of the domain go on behind
//   it
//
// Sound speeds are numerical in one method and chosen in another, and stay behind. So do sections and keys of the file
// that belong to other methods; those of the command line are left for the reader to refuse. The nodes keep
// their places in the file. Anything that is not of the expected type is left alone.
Translation translate(Node& document, const CaseSchema& schema, const std::string& file);

}  // namespace spume
