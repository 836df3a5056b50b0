// Subset simulation by OpenTURNS, in a file that the program loads when a campaign asks for it: the library
// brings ninety others, which would cost each start of the program a tenth of a second.
#include <exception>
#include <openturns/CompositeRandomVector.hxx>
#include <openturns/EvaluationImplementation.hxx>
#include <openturns/Greater.hxx>
#include <openturns/Less.hxx>
#include <openturns/Normal.hxx>
#include <openturns/RandomGenerator.hxx>
#include <openturns/SubsetSampling.hxx>
#include <openturns/ThresholdEvent.hxx>

#include "study/campaign/rare.hpp"

namespace twinchute::study {
namespace {

class Metric : public OT::EvaluationImplementation {
public:
    Metric(const SubsetTask& task, std::exception_ptr& thrown) : task_(task), thrown_(thrown) {}

    Metric* clone() const override { return new Metric(*this); }
    OT::UnsignedInteger getInputDimension() const override { return task_.dimensions; }
    OT::UnsignedInteger getOutputDimension() const override { return 1; }
    OT::Point operator()(const OT::Point& point) const override { return (*this)(OT::Sample(1, point))[0]; }
    OT::Sample operator()(const OT::Sample& points) const override {
        const OT::UnsignedInteger count = points.getSize();
        std::vector<double> scores, values(count);
        for (OT::UnsignedInteger i = 0; i < count; ++i)
            for (OT::UnsignedInteger k = 0; k < task_.dimensions; ++k)
                scores.push_back(points(i, k));
        try {
            task_.at(scores, values);
        } catch (...) {
            thrown_ = std::current_exception();  // the library throws what it makes of it
            throw;
        }
        OT::Sample all(count, 1);
        for (OT::UnsignedInteger i = 0; i < count; ++i)
            all(i, 0) = values[i];
        return all;
    }

private:
    const SubsetTask& task_;
    std::exception_ptr& thrown_;
};

void simulate(const SubsetTask& task, std::exception_ptr& thrown, SubsetEstimate& found) {
    // The generator is the library's own, one for the process.
    OT::RandomGenerator::SetSeed(static_cast<OT::UnsignedInteger>(task.seed >> 32));
    const OT::RandomVector inputs{OT::Normal(static_cast<OT::UnsignedInteger>(task.dimensions))};
    const OT::CompositeRandomVector metric(OT::Function(Metric(task, thrown)), inputs);
    const OT::ComparisonOperator passes =
        task.above ? OT::ComparisonOperator(OT::Greater()) : OT::ComparisonOperator(OT::Less());
    OT::SubsetSampling sampling(OT::ThresholdEvent(metric, passes, task.threshold));
    // A tenth of a level are its seeds: each block is one step of all chains.
    sampling.setMaximumOuterSampling(10);
    sampling.setBlockSize(task.block);
    sampling.setConditionalProbability(0.1);
    sampling.setMinimumProbability(least_probability);
    sampling.setKeepEventSample(true);
    try {
        sampling.run();
        found.probability = sampling.getResult().getProbabilityEstimate();
    } catch (const OT::NotDefinedException&) {
        const OT::Point levels = sampling.getProbabilityEstimatePerStep();
        if (thrown || levels.isEmpty() || levels[levels.getSize() - 1] > least_probability) throw;
        found.probability = levels[levels.getSize() - 1];
    }
    found.levels = static_cast<int>(sampling.getStepsNumber());
    // Strictly past a threshold that a tenth of a level share, there is nothing.
    if (found.probability == 0.0)
        found.gave_up = "the metric takes one value in a tenth or more of the runs of a level";
    const OT::Sample points = sampling.getEventInputSample();
    for (OT::UnsignedInteger i = 0; i < points.getSize(); ++i)
        for (OT::UnsignedInteger k = 0; k < task.dimensions; ++k)
            found.points.push_back(points(i, k));
}

}  // namespace
}  // namespace twinchute::study

extern "C" void twinchute_simulate_subsets(const twinchute::study::SubsetTask& task,
                                           twinchute::study::SubsetEstimate& found) {
    std::exception_ptr thrown;
    try {
        twinchute::study::simulate(task, thrown, found);
    } catch (const std::exception& error) {
        if (thrown) std::rethrow_exception(thrown);
        found.gave_up = error.what();
    }
}
