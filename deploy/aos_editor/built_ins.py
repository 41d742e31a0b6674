"""The meaning of each built-in of model code and mapping code, in one sentence."""

from collections.abc import Mapping

BUILT_INS: Mapping[str, str] = {
    "state": "The state before the step.",
    "state_": "The state after the extrinsic changes.",
    "state__": "The state after the skill: what the dynamic model writes.",
    "state___": "The state that a real observation corrects.",
    "__reward": "The reward of this code; all rewards of a step are added.",
    "__isGoalState": "Whether the mission ends in this state.",
    "__isFailureState": "Whether it ends as a failure. Code without this word lets the reward's sign say.",
    "__stopEvaluatingState": "Whether this special state is not looked at again.",
    "__meetPrecondition": "Whether the skill may be used; true at the start.",
    "__heuristicValue": "A skill's weight in play-outs, or a state's worth where the search ends.",
    "__possibleParameters": "The list of the skill's parameter values, as tuples.",
    "__moduleExecutionTime": "How long the skill takes.",
    "__moduleResponse": "The response the skill gives: one that its mapping names.",
    "__moduleResponseStr": "The response as any text.",
    "__observed": "Numbers beside the response: `__observed.NAME = AOS.SampleNormal(mean, deviation)`.",
    "__input": "The call's result, or the topic's message.",
    "AOS.Bernoulli": "`AOS.Bernoulli(p)`: true with probability p.",
    "AOS.SampleDiscrete": "`AOS.SampleDiscrete(Enum, {weights})`: a value, by normalised weights.",
    "AOS.SampleNormal": "`AOS.SampleNormal(mean, deviation)`: a draw from a normal distribution.",
    "AOS.SampleUniform": "`AOS.SampleUniform(low, high)`: a draw from a uniform distribution.",
    "AOS.SetNull": "Takes an `anyValue` away.",
    "AOS.IsInitialized": "Whether an `anyValue` is there.",
    "AOS.Initialize": "Says that an `anyValue` is there.",
    "AOS.Uninitialize": "Says that an `anyValue` is not there any more.",
    "AOSUtils::SampleDiscrete": "An index drawn with the given probabilities; -1 for what they miss to 1.",
}
"""Names that the system gives to model code and mapping code."""
