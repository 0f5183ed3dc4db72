"""OpenSCENARIO: distributions of parameter values; the notation is in `structure.notation`."""

DISTRIBUTION_ELEMENTS = """
ParameterValueDistribution
    = ScenarioFile=File (Deterministic | Stochastic)
Deterministic
    = (DeterministicMultiParameterDistribution | DeterministicSingleParameterDistribution)*
DeterministicMultiParameterDistribution
    = ValueSetDistribution
ValueSetDistribution
    = ParameterValueSet+
ParameterValueSet
    = ParameterAssignment+
DeterministicSingleParameterDistribution
    parameterName
    = DistributionSet | DistributionRange | UserDefinedDistribution
DistributionSet
    = Element=DistributionSetElement+
DistributionSetElement
    value
DistributionRange
    stepWidth:Double
    = Range
Range
    lowerLimit:Double upperLimit:Double
UserDefinedDistribution
    type
    = text
Stochastic
    numberOfTestRuns:UnsignedInt randomSeed?:Double
    = StochasticDistribution+
StochasticDistribution
    parameterName
    = ProbabilityDistributionSet | NormalDistribution | LogNormalDistribution@1.3- | UniformDistribution |
      PoissonDistribution | Histogram | UserDefinedDistribution
ProbabilityDistributionSet
    = Element=ProbabilityDistributionSetElement+
ProbabilityDistributionSetElement
    value weight:Double
NormalDistribution
    expectedValue:Double variance:Double
    = Range?
LogNormalDistribution
    expectedValue:Double variance:Double
    = Range?
UniformDistribution
    = Range
PoissonDistribution
    expectedValue:Double
    = Range?
Histogram
    = Bin=HistogramBin+
HistogramBin
    weight:Double
    = Range
"""
