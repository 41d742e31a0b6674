"""What is said on the bus, one module for each conversation.

Every payload is an `Envelope` whose body is one of these structures. Times are wall-clock nanoseconds for
people and journals; nothing is decided by them. Unknown fields are ignored, so that minor versions mix.
"""

from __future__ import annotations

from aos_protocol.messages.base import (
    Envelope,
    Fault,
    Message,
)
from aos_protocol.messages.bundles import (
    BundleReport,
    Catalogue,
    CatalogueEntry,
    CatalogueQuery,
    ProjectQuery,
    ProjectRevision,
    PushBundle,
    RemoveDocuments,
    RevisionEntry,
    Revisions,
    RevisionsQuery,
)
from aos_protocol.messages.mission import (
    ActionValue,
    BeliefSummary,
    CheckModel,
    ConstraintRisk,
    DecisionRecord,
    History,
    HistoryQuery,
    Marginal,
    MissionQuery,
    MissionState,
    ModelCheck,
    PredictedObservation,
    ResumeMission,
    StartMission,
)
from aos_protocol.messages.skills import (
    Activate,
    ActivationId,
    Cancel,
    Cancelled,
    MappingQuery,
    MappingState,
    Outcome,
    SkillCall,
    SkillProgress,
    SkillResult,
    Stray,
    TopicMessage,
)

__all__ = [
    "ActionValue",
    "Activate",
    "ActivationId",
    "BeliefSummary",
    "BundleReport",
    "Cancel",
    "Cancelled",
    "Catalogue",
    "CatalogueEntry",
    "CatalogueQuery",
    "CheckModel",
    "ConstraintRisk",
    "DecisionRecord",
    "Envelope",
    "Fault",
    "History",
    "HistoryQuery",
    "MappingQuery",
    "MappingState",
    "Marginal",
    "Message",
    "MissionQuery",
    "MissionState",
    "ModelCheck",
    "Outcome",
    "PredictedObservation",
    "ProjectQuery",
    "ProjectRevision",
    "PushBundle",
    "RemoveDocuments",
    "ResumeMission",
    "RevisionEntry",
    "Revisions",
    "RevisionsQuery",
    "SkillCall",
    "SkillProgress",
    "SkillResult",
    "StartMission",
    "Stray",
    "TopicMessage",
]
