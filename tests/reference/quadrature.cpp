#include "tests/reference/quadrature.h"

namespace tetravox::reference {
namespace {

/// Nodes and weights on [-1, 1] (symmetric halves).
constexpr std::array<double, 5> kHalfNodes = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                              0.8650633666889845, 0.9739065285171717};
constexpr std::array<double, 5> kHalfWeights = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                                0.1494513491505806, 0.0666713443086881};

double lagrange(const std::array<double, kNodeCount>& nodes, int j, double u) {
  double product = 1.0;
  for (int i = 0; i < kNodeCount; ++i)
    if (i != j) product *= (u - nodes[i]) / (nodes[j] - nodes[i]);
  return product;
}

GaussRule make_rule() {
  GaussRule rule;
  for (int i = 0; i < 5; ++i) {
    rule.node[4 - i] = 0.5 - 0.5 * kHalfNodes[i];
    rule.node[5 + i] = 0.5 + 0.5 * kHalfNodes[i];
    rule.weight[4 - i] = rule.weight[5 + i] = 0.5 * kHalfWeights[i];
  }
  for (int i = 0; i < kNodeCount; ++i)
    for (int j = 0; j < kNodeCount; ++j)
      for (int k = 0; k < kNodeCount; ++k)
        rule.gathered[i][j] += rule.node[i] * rule.weight[k] * lagrange(rule.node, j, rule.node[i] * rule.node[k]);
  return rule;
}

}  // namespace

const GaussRule& gauss_rule() {
  static const GaussRule rule = make_rule();
  return rule;
}

}  // namespace tetravox::reference
