// The list of effects: MJDIAG_EFFECT(function) for every one. Included by registry.h
// and registry.cc only, each of which says what is made of an entry.

// Friction and hysteresis
MJDIAG_EFFECT(CoulombFriction)
MJDIAG_EFFECT(StribeckFriction)
MJDIAG_EFFECT(ViscousFriction)
MJDIAG_EFFECT(AsymmetricViscousFriction)
MJDIAG_EFFECT(QuadraticDrag)
MJDIAG_EFFECT(PreslidingHysteresis)
MJDIAG_EFFECT(HystereticStiffness)
// Motors and drives
MJDIAG_EFFECT(ForceOffset)
MJDIAG_EFFECT(ForceRipple)
MJDIAG_EFFECT(MotorConstant)
MJDIAG_EFFECT(PositionDependentMotorConstant)
MJDIAG_EFFECT(ForceSaturation)
MJDIAG_EFFECT(InputDelay)
MJDIAG_EFFECT(AmplifierLag)
// Structure and surroundings
MJDIAG_EFFECT(LinearStiffness)
MJDIAG_EFFECT(CubicStiffness)
MJDIAG_EFFECT(StructuralStiffness)
MJDIAG_EFFECT(AddedMass)
MJDIAG_EFFECT(FlexibleMode)
MJDIAG_EFFECT(Backlash)
MJDIAG_EFFECT(EndStop)
MJDIAG_EFFECT(FloorVibration)
// Encoders
MJDIAG_EFFECT(EncoderScale)
MJDIAG_EFFECT(EncoderPeriodicError)
MJDIAG_EFFECT(EncoderDrift)
MJDIAG_EFFECT(EncoderNoise)
// Added after those above, which a benchmark draws in this order
MJDIAG_EFFECT(LoadFriction)
