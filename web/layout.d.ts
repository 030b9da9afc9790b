export const ABI: 1;
export const ALIGN: 64;
export const LANDMARKS: 68;
export const ANIMATIONS: 24;
export const UNREAD_EVENTS: 64;
export namespace STATUS {
    let OK: number;
    let E_ARG: number;
    let E_MEMORY: number;
    let E_MODEL: number;
    let E_FRAME: number;
    let E_TIME: number;
    let E_FORMAT: number;
    let E_MODEL_ALIGN: number;
    let E_MODEL_TRUNCATED: number;
    let E_MODEL_MAGIC: number;
    let E_MODEL_VERSION: number;
    let E_MODEL_CHECKSUM: number;
    let E_NULL: number;
    let E_POINTER_ALIGN: number;
    let E_STRUCT_SIZE: number;
    let E_TRACKER: number;
    let E_OVERLAP: number;
    let E_FLAGS: number;
    let E_INTRINSICS: number;
    let E_MIN_FACE: number;
    let E_SCAN_BUDGET: number;
    let E_SMOOTHING: number;
    let E_HINT: number;
    let E_ROI: number;
    let E_EXCLUDED: number;
    let E_LENS: number;
    let E_MONITOR: number;
    let E_MONITOR_CONFIG: number;
    let E_ZONES: number;
}
export namespace FORMATS {
    let GREY: number;
    let Y10: number;
    let Y16: number;
    let YUYV: number;
    let UYVY: number;
    let NV12: number;
    let NV21: number;
    let YU12: number;
    let RGB3: number;
    let BGR3: number;
    let XB24: number;
    let AB24: number;
    let XR24: number;
    let AR24: number;
    let BX24: number;
    let BA24: number;
    let RX24: number;
    let RA24: number;
}
/** @typedef {(typeof STATES)[number]} State */
export const STATES: readonly ["searching", "tracking", "coasting"];
/** @typedef {(typeof LOSSES)[number]} Loss */
export const LOSSES: readonly ["none", "low_confidence", "left_frame", "no_pose", "excluded"];
/** @typedef {(typeof EVENTS)[number]} EventKind */
export const EVENTS: readonly ["acquired", "reacquired", "coasting", "lost", "suppressed", "filter_on", "filter_off", "reset", "forgotten"];
/** @typedef {(typeof LENSES)[number]} LensModel */
export const LENSES: readonly ["pinhole", "brown", "fisheye"];
export namespace INTRINSICS {
    let size: number;
    namespace fields {
        namespace fx {
            let at: number;
            let type: string;
        }
        namespace fy {
            let at_1: number;
            export { at_1 as at };
            let type_1: string;
            export { type_1 as type };
        }
        namespace cx {
            let at_2: number;
            export { at_2 as at };
            let type_2: string;
            export { type_2 as type };
        }
        namespace cy {
            let at_3: number;
            export { at_3 as at };
            let type_3: string;
            export { type_3 as type };
        }
    }
}
export namespace LENS {
    let size_1: number;
    export { size_1 as size };
    export namespace fields_1 {
        namespace model {
            let at_4: number;
            export { at_4 as at };
            let type_4: string;
            export { type_4 as type };
            export { LENSES as names };
        }
        namespace coefficients {
            let at_5: number;
            export { at_5 as at };
            let type_5: string;
            export { type_5 as type };
            export let count: number;
        }
    }
    export { fields_1 as fields };
}
export namespace CONFIG {
    let size_2: number;
    export { size_2 as size };
    export namespace fields_2 {
        namespace structSize {
            let at_6: number;
            export { at_6 as at };
            let type_6: string;
            export { type_6 as type };
        }
        namespace flags {
            let at_7: number;
            export { at_7 as at };
            let type_7: string;
            export { type_7 as type };
        }
        namespace minFacePx {
            let at_8: number;
            export { at_8 as at };
            let type_8: string;
            export { type_8 as type };
        }
        namespace scanBudget {
            let at_9: number;
            export { at_9 as at };
            let type_9: string;
            export { type_9 as type };
        }
        namespace intrinsics {
            let at_10: number;
            export { at_10 as at };
            export { INTRINSICS as struct };
        }
        namespace smoothingHz {
            let at_11: number;
            export { at_11 as at };
            let type_10: string;
            export { type_10 as type };
        }
        namespace smoothingBeta {
            let at_12: number;
            export { at_12 as at };
            let type_11: string;
            export { type_11 as type };
        }
        namespace lens {
            let at_13: number;
            export { at_13 as at };
            export { LENS as struct };
        }
        namespace gaze {
            let at_14: number;
            export { at_14 as at };
            let type_12: string;
            export { type_12 as type };
        }
    }
    export { fields_2 as fields };
}
export namespace FRAME {
    let size_3: number;
    export { size_3 as size };
    export namespace fields_3 {
        export namespace structSize_1 {
            let at_15: number;
            export { at_15 as at };
            let type_13: string;
            export { type_13 as type };
        }
        export { structSize_1 as structSize };
        export namespace format {
            let at_16: number;
            export { at_16 as at };
            let type_14: string;
            export { type_14 as type };
        }
        export namespace timestampUs {
            let at_17: number;
            export { at_17 as at };
            let type_15: string;
            export { type_15 as type };
        }
        export namespace width {
            let at_18: number;
            export { at_18 as at };
            let type_16: string;
            export { type_16 as type };
        }
        export namespace height {
            let at_19: number;
            export { at_19 as at };
            let type_17: string;
            export { type_17 as type };
        }
        export namespace stride {
            let at_20: number;
            export { at_20 as at };
            let type_18: string;
            export { type_18 as type };
        }
        export namespace rotationDeg {
            let at_21: number;
            export { at_21 as at };
            let type_19: string;
            export { type_19 as type };
        }
        export namespace flags_1 {
            let at_22: number;
            export { at_22 as at };
            let type_20: string;
            export { type_20 as type };
        }
        export { flags_1 as flags };
        export namespace reserved {
            let at_23: number;
            export { at_23 as at };
            let type_21: string;
            export { type_21 as type };
        }
        export namespace dataLen {
            let at_24: number;
            export { at_24 as at };
            let type_22: string;
            export { type_22 as type };
        }
        export namespace data {
            let at_25: number;
            export { at_25 as at };
            let type_23: string;
            export { type_23 as type };
        }
    }
    export { fields_3 as fields };
}
export namespace RESULT {
    let size_4: number;
    export { size_4 as size };
    export namespace fields_4 {
        export namespace structSize_2 {
            let at_26: number;
            export { at_26 as at };
            let type_24: string;
            export { type_24 as type };
        }
        export { structSize_2 as structSize };
        export namespace state {
            let at_27: number;
            export { at_27 as at };
            let type_25: string;
            export { type_25 as type };
            export { STATES as names };
        }
        export namespace timestampUs_1 {
            let at_28: number;
            export { at_28 as at };
            let type_26: string;
            export { type_26 as type };
        }
        export { timestampUs_1 as timestampUs };
        export namespace ageUs {
            let at_29: number;
            export { at_29 as at };
            let type_27: string;
            export { type_27 as type };
        }
        export namespace landmarkCount {
            let at_30: number;
            export { at_30 as at };
            let type_28: string;
            export { type_28 as type };
        }
        export namespace confidence {
            let at_31: number;
            export { at_31 as at };
            let type_29: string;
            export { type_29 as type };
        }
        export namespace faceBox {
            let at_32: number;
            export { at_32 as at };
            let type_30: string;
            export { type_30 as type };
            let count_1: number;
            export { count_1 as count };
        }
        export namespace rotation {
            let at_33: number;
            export { at_33 as at };
            let type_31: string;
            export { type_31 as type };
            let count_2: number;
            export { count_2 as count };
        }
        export namespace yawDeg {
            let at_34: number;
            export { at_34 as at };
            let type_32: string;
            export { type_32 as type };
        }
        export namespace pitchDeg {
            let at_35: number;
            export { at_35 as at };
            let type_33: string;
            export { type_33 as type };
        }
        export namespace rollDeg {
            let at_36: number;
            export { at_36 as at };
            let type_34: string;
            export { type_34 as type };
        }
        export namespace translationMm {
            let at_37: number;
            export { at_37 as at };
            let type_35: string;
            export { type_35 as type };
            let count_3: number;
            export { count_3 as count };
        }
        export namespace eyeOpen {
            let at_38: number;
            export { at_38 as at };
            let type_36: string;
            export { type_36 as type };
            let count_4: number;
            export { count_4 as count };
        }
        export namespace loss {
            let at_39: number;
            export { at_39 as at };
            let type_37: string;
            export { type_37 as type };
            export { LOSSES as names };
        }
        export namespace visibleShare {
            let at_40: number;
            export { at_40 as at };
            let type_38: string;
            export { type_38 as type };
        }
        export namespace rotationSigmaDeg {
            let at_41: number;
            export { at_41 as at };
            let type_39: string;
            export { type_39 as type };
            let count_5: number;
            export { count_5 as count };
        }
        export namespace translationSigmaMm {
            let at_42: number;
            export { at_42 as at };
            let type_40: string;
            export { type_40 as type };
            let count_6: number;
            export { count_6 as count };
        }
        export namespace eyeOpenProbability {
            let at_43: number;
            export { at_43 as at };
            let type_41: string;
            export { type_41 as type };
            let count_7: number;
            export { count_7 as count };
        }
        export namespace eyeUnknown {
            let at_44: number;
            export { at_44 as at };
            let type_42: string;
            export { type_42 as type };
            let count_8: number;
            export { count_8 as count };
        }
        export namespace irisLeft {
            let at_45: number;
            export { at_45 as at };
            let type_43: string;
            export { type_43 as type };
            let count_9: number;
            export { count_9 as count };
        }
        export namespace irisRight {
            let at_46: number;
            export { at_46 as at };
            let type_44: string;
            export { type_44 as type };
            let count_10: number;
            export { count_10 as count };
        }
        export namespace gazeUnknown {
            let at_47: number;
            export { at_47 as at };
            let type_45: string;
            export { type_45 as type };
            let count_11: number;
            export { count_11 as count };
        }
        export namespace gazeSigmaDeg {
            let at_48: number;
            export { at_48 as at };
            let type_46: string;
            export { type_46 as type };
            let count_12: number;
            export { count_12 as count };
        }
        export namespace gazeLeft {
            let at_49: number;
            export { at_49 as at };
            let type_47: string;
            export { type_47 as type };
            let count_13: number;
            export { count_13 as count };
        }
        export namespace gazeRight {
            let at_50: number;
            export { at_50 as at };
            let type_48: string;
            export { type_48 as type };
            let count_14: number;
            export { count_14 as count };
        }
        export namespace gaze_1 {
            let at_51: number;
            export { at_51 as at };
            let type_49: string;
            export { type_49 as type };
            let count_15: number;
            export { count_15 as count };
        }
        export { gaze_1 as gaze };
        export namespace gazeHead {
            let at_52: number;
            export { at_52 as at };
            let type_50: string;
            export { type_50 as type };
            let count_16: number;
            export { count_16 as count };
        }
        export namespace glasses {
            let at_53: number;
            export { at_53 as at };
            let type_51: string;
            export { type_51 as type };
        }
        export namespace darkGlasses {
            let at_54: number;
            export { at_54 as at };
            let type_52: string;
            export { type_52 as type };
        }
        export namespace eyeLook {
            let at_55: number;
            export { at_55 as at };
            let type_53: string;
            export { type_53 as type };
            let count_17: number;
            export { count_17 as count };
        }
        export namespace facingYawDeg {
            let at_56: number;
            export { at_56 as at };
            let type_54: string;
            export { type_54 as type };
        }
        export namespace facingPitchDeg {
            let at_57: number;
            export { at_57 as at };
            let type_55: string;
            export { type_55 as type };
        }
        export namespace facingRollDeg {
            let at_58: number;
            export { at_58 as at };
            let type_56: string;
            export { type_56 as type };
        }
        export namespace facingSigmaDeg {
            let at_59: number;
            export { at_59 as at };
            let type_57: string;
            export { type_57 as type };
            let count_18: number;
            export { count_18 as count };
        }
        export namespace focalPx {
            let at_60: number;
            export { at_60 as at };
            let type_58: string;
            export { type_58 as type };
        }
        export namespace cameraAssumed {
            let at_61: number;
            export { at_61 as at };
            let type_59: string;
            export { type_59 as type };
        }
    }
    export { fields_4 as fields };
}
export namespace HINT {
    let size_5: number;
    export { size_5 as size };
    export namespace fields_5 {
        export namespace structSize_3 {
            let at_62: number;
            export { at_62 as at };
            let type_60: string;
            export { type_60 as type };
        }
        export { structSize_3 as structSize };
        export namespace faceBox_1 {
            let at_63: number;
            export { at_63 as at };
            let type_61: string;
            export { type_61 as type };
            let count_19: number;
            export { count_19 as count };
        }
        export { faceBox_1 as faceBox };
        export namespace yawDeg_1 {
            let at_64: number;
            export { at_64 as at };
            let type_62: string;
            export { type_62 as type };
        }
        export { yawDeg_1 as yawDeg };
        export namespace rollDeg_1 {
            let at_65: number;
            export { at_65 as at };
            let type_63: string;
            export { type_63 as type };
        }
        export { rollDeg_1 as rollDeg };
    }
    export { fields_5 as fields };
}
export namespace FACE {
    let size_6: number;
    export { size_6 as size };
    export namespace fields_6 {
        export namespace faceBox_2 {
            let at_66: number;
            export { at_66 as at };
            let type_64: string;
            export { type_64 as type };
            let count_20: number;
            export { count_20 as count };
        }
        export { faceBox_2 as faceBox };
        export namespace yawDeg_2 {
            let at_67: number;
            export { at_67 as at };
            let type_65: string;
            export { type_65 as type };
        }
        export { yawDeg_2 as yawDeg };
        export namespace rollDeg_2 {
            let at_68: number;
            export { at_68 as at };
            let type_66: string;
            export { type_66 as type };
        }
        export { rollDeg_2 as rollDeg };
        export namespace confidence_1 {
            let at_69: number;
            export { at_69 as at };
            let type_67: string;
            export { type_67 as type };
        }
        export { confidence_1 as confidence };
    }
    export { fields_6 as fields };
}
export namespace LANDMARK {
    let size_7: number;
    export { size_7 as size };
    export namespace fields_7 {
        export namespace x {
            let at_70: number;
            export { at_70 as at };
            let type_68: string;
            export { type_68 as type };
        }
        export namespace y {
            let at_71: number;
            export { at_71 as at };
            let type_69: string;
            export { type_69 as type };
        }
        export namespace confidence_2 {
            let at_72: number;
            export { at_72 as at };
            let type_70: string;
            export { type_70 as type };
        }
        export { confidence_2 as confidence };
        export namespace visibility {
            let at_73: number;
            export { at_73 as at };
            let type_71: string;
            export { type_71 as type };
        }
        export namespace xMm {
            let at_74: number;
            export { at_74 as at };
            let type_72: string;
            export { type_72 as type };
        }
        export namespace yMm {
            let at_75: number;
            export { at_75 as at };
            let type_73: string;
            export { type_73 as type };
        }
        export namespace zMm {
            let at_76: number;
            export { at_76 as at };
            let type_74: string;
            export { type_74 as type };
        }
    }
    export { fields_7 as fields };
}
export namespace EVENT {
    let size_8: number;
    export { size_8 as size };
    export namespace fields_8 {
        export namespace timestampUs_2 {
            let at_77: number;
            export { at_77 as at };
            let type_75: string;
            export { type_75 as type };
        }
        export { timestampUs_2 as timestampUs };
        export namespace kind {
            let at_78: number;
            export { at_78 as at };
            let type_76: string;
            export { type_76 as type };
            export { EVENTS as names };
        }
        export namespace loss_1 {
            let at_79: number;
            export { at_79 as at };
            let type_77: string;
            export { type_77 as type };
            export { LOSSES as names };
        }
        export { loss_1 as loss };
        export namespace faceBox_3 {
            let at_80: number;
            export { at_80 as at };
            let type_78: string;
            export { type_78 as type };
            let count_21: number;
            export { count_21 as count };
        }
        export { faceBox_3 as faceBox };
        export namespace confidence_3 {
            let at_81: number;
            export { at_81 as at };
            let type_79: string;
            export { type_79 as type };
        }
        export { confidence_3 as confidence };
        export namespace reserved_1 {
            let at_82: number;
            export { at_82 as at };
            let type_80: string;
            export { type_80 as type };
        }
        export { reserved_1 as reserved };
    }
    export { fields_8 as fields };
}
export namespace ROI {
    let size_9: number;
    export { size_9 as size };
    export namespace fields_9 {
        export namespace x_1 {
            let at_83: number;
            export { at_83 as at };
            let type_81: string;
            export { type_81 as type };
        }
        export { x_1 as x };
        export namespace y_1 {
            let at_84: number;
            export { at_84 as at };
            let type_82: string;
            export { type_82 as type };
        }
        export { y_1 as y };
        export namespace width_1 {
            let at_85: number;
            export { at_85 as at };
            let type_83: string;
            export { type_83 as type };
        }
        export { width_1 as width };
        export namespace height_1 {
            let at_86: number;
            export { at_86 as at };
            let type_84: string;
            export { type_84 as type };
        }
        export { height_1 as height };
    }
    export { fields_9 as fields };
}
export namespace MONITOR_CONFIG {
    let size_10: number;
    export { size_10 as size };
    export namespace fields_10 {
        export namespace structSize_4 {
            let at_87: number;
            export { at_87 as at };
            let type_85: string;
            export { type_85 as type };
        }
        export { structSize_4 as structSize };
        export namespace flags_2 {
            let at_88: number;
            export { at_88 as at };
            let type_86: string;
            export { type_86 as type };
        }
        export { flags_2 as flags };
        export namespace preset {
            let at_89: number;
            export { at_89 as at };
            let type_87: string;
            export { type_87 as type };
        }
        export namespace gapUs {
            let at_90: number;
            export { at_90 as at };
            let type_88: string;
            export { type_88 as type };
        }
        export namespace minConfidence {
            let at_91: number;
            export { at_91 as at };
            let type_89: string;
            export { type_89 as type };
        }
        export namespace eyeYawDeg {
            let at_92: number;
            export { at_92 as at };
            let type_90: string;
            export { type_90 as type };
        }
        export namespace eyePitchDeg {
            let at_93: number;
            export { at_93 as at };
            let type_91: string;
            export { type_91 as type };
        }
        export namespace closedBelow {
            let at_94: number;
            export { at_94 as at };
            let type_92: string;
            export { type_92 as type };
        }
        export namespace openAbove {
            let at_95: number;
            export { at_95 as at };
            let type_93: string;
            export { type_93 as type };
        }
        export namespace blinkUs {
            let at_96: number;
            export { at_96 as at };
            let type_94: string;
            export { type_94 as type };
        }
        export namespace longClosureUs {
            let at_97: number;
            export { at_97 as at };
            let type_95: string;
            export { type_95 as type };
        }
        export namespace microsleepUs {
            let at_98: number;
            export { at_98 as at };
            let type_96: string;
            export { type_96 as type };
        }
        export namespace sleepUs {
            let at_99: number;
            export { at_99 as at };
            let type_97: string;
            export { type_97 as type };
        }
        export namespace unresponsiveUs {
            let at_100: number;
            export { at_100 as at };
            let type_98: string;
            export { type_98 as type };
        }
        export namespace drowsyP8060 {
            let at_101: number;
            export { at_101 as at };
            let type_99: string;
            export { type_99 as type };
        }
        export namespace drowsyP80180 {
            let at_102: number;
            export { at_102 as at };
            let type_100: string;
            export { type_100 as type };
        }
        export namespace awakeShare {
            let at_103: number;
            export { at_103 as at };
            let type_101: string;
            export { type_101 as type };
        }
        export namespace minKnown {
            let at_104: number;
            export { at_104 as at };
            let type_102: string;
            export { type_102 as type };
        }
        export namespace yawnAbove {
            let at_105: number;
            export { at_105 as at };
            let type_103: string;
            export { type_103 as type };
        }
        export namespace yawnBelow {
            let at_106: number;
            export { at_106 as at };
            let type_104: string;
            export { type_104 as type };
        }
        export namespace yawnUs {
            let at_107: number;
            export { at_107 as at };
            let type_105: string;
            export { type_105 as type };
        }
        export namespace yawnMaxUs {
            let at_108: number;
            export { at_108 as at };
            let type_106: string;
            export { type_106 as type };
        }
        export namespace nodDeg {
            let at_109: number;
            export { at_109 as at };
            let type_107: string;
            export { type_107 as type };
        }
        export namespace nodUs {
            let at_110: number;
            export { at_110 as at };
            let type_108: string;
            export { type_108 as type };
        }
        export namespace forwardYawDeg {
            let at_111: number;
            export { at_111 as at };
            let type_109: string;
            export { type_109 as type };
        }
        export namespace forwardPitchDeg {
            let at_112: number;
            export { at_112 as at };
            let type_110: string;
            export { type_110 as type };
        }
        export namespace naturalYawDeg {
            let at_113: number;
            export { at_113 as at };
            let type_111: string;
            export { type_111 as type };
        }
        export namespace naturalPitchDeg {
            let at_114: number;
            export { at_114 as at };
            let type_112: string;
            export { type_112 as type };
        }
        export namespace zoneMarginDeg {
            let at_115: number;
            export { at_115 as at };
            let type_113: string;
            export { type_113 as type };
        }
        export namespace longGlanceUs {
            let at_116: number;
            export { at_116 as at };
            let type_114: string;
            export { type_114 as type };
        }
        export namespace cumulativeUs {
            let at_117: number;
            export { at_117 as at };
            let type_115: string;
            export { type_115 as type };
        }
        export namespace returnUs {
            let at_118: number;
            export { at_118 as at };
            let type_116: string;
            export { type_116 as type };
        }
        export namespace clearUs {
            let at_119: number;
            export { at_119 as at };
            let type_117: string;
            export { type_117 as type };
        }
        export namespace degradedUs {
            let at_120: number;
            export { at_120 as at };
            let type_118: string;
            export { type_118 as type };
        }
    }
    export { fields_10 as fields };
}
export namespace OBSERVATION {
    let size_11: number;
    export { size_11 as size };
    export namespace fields_11 {
        export namespace structSize_5 {
            let at_121: number;
            export { at_121 as at };
            let type_119: string;
            export { type_119 as type };
        }
        export { structSize_5 as structSize };
        export namespace state_1 {
            let at_122: number;
            export { at_122 as at };
            let type_120: string;
            export { type_120 as type };
        }
        export { state_1 as state };
        export namespace confidence_4 {
            let at_123: number;
            export { at_123 as at };
            let type_121: string;
            export { type_121 as type };
        }
        export { confidence_4 as confidence };
        export namespace yawDeg_3 {
            let at_124: number;
            export { at_124 as at };
            let type_122: string;
            export { type_122 as type };
        }
        export { yawDeg_3 as yawDeg };
        export namespace pitchDeg_1 {
            let at_125: number;
            export { at_125 as at };
            let type_123: string;
            export { type_123 as type };
        }
        export { pitchDeg_1 as pitchDeg };
        export namespace translationMm_1 {
            let at_126: number;
            export { at_126 as at };
            let type_124: string;
            export { type_124 as type };
            let count_22: number;
            export { count_22 as count };
        }
        export { translationMm_1 as translationMm };
        export namespace rotationSigmaDeg_1 {
            let at_127: number;
            export { at_127 as at };
            let type_125: string;
            export { type_125 as type };
            let count_23: number;
            export { count_23 as count };
        }
        export { rotationSigmaDeg_1 as rotationSigmaDeg };
        export namespace eyeOpen_1 {
            let at_128: number;
            export { at_128 as at };
            let type_126: string;
            export { type_126 as type };
            let count_24: number;
            export { count_24 as count };
        }
        export { eyeOpen_1 as eyeOpen };
        export namespace jawOpen {
            let at_129: number;
            export { at_129 as at };
            let type_127: string;
            export { type_127 as type };
        }
        export namespace cameraAssumed_1 {
            let at_130: number;
            export { at_130 as at };
            let type_128: string;
            export { type_128 as type };
        }
        export { cameraAssumed_1 as cameraAssumed };
    }
    export { fields_11 as fields };
}
export namespace PERCLOS {
    let size_12: number;
    export { size_12 as size };
    export namespace fields_12 {
        namespace p70 {
            let at_131: number;
            export { at_131 as at };
            let type_129: string;
            export { type_129 as type };
        }
        namespace p80 {
            let at_132: number;
            export { at_132 as at };
            let type_130: string;
            export { type_130 as type };
        }
        namespace em {
            let at_133: number;
            export { at_133 as at };
            let type_131: string;
            export { type_131 as type };
        }
        namespace known {
            let at_134: number;
            export { at_134 as at };
            let type_132: string;
            export { type_132 as type };
        }
        namespace closures {
            let at_135: number;
            export { at_135 as at };
            let type_133: string;
            export { type_133 as type };
        }
        namespace meanClosureUs {
            let at_136: number;
            export { at_136 as at };
            let type_134: string;
            export { type_134 as type };
        }
    }
    export { fields_12 as fields };
}
export namespace MONITOR_STATE {
    let size_13: number;
    export { size_13 as size };
    export namespace fields_13 {
        export namespace structSize_6 {
            let at_137: number;
            export { at_137 as at };
            let type_135: string;
            export { type_135 as type };
        }
        export { structSize_6 as structSize };
        export namespace eyes {
            let at_138: number;
            export { at_138 as at };
            let type_136: string;
            export { type_136 as type };
        }
        export namespace timestampUs_3 {
            let at_139: number;
            export { at_139 as at };
            let type_137: string;
            export { type_137 as type };
        }
        export { timestampUs_3 as timestampUs };
        export namespace eyesUnknown {
            let at_140: number;
            export { at_140 as at };
            let type_138: string;
            export { type_138 as type };
        }
        export namespace openness {
            let at_141: number;
            export { at_141 as at };
            let type_139: string;
            export { type_139 as type };
        }
        export namespace closureUs {
            let at_142: number;
            export { at_142 as at };
            let type_140: string;
            export { type_140 as type };
        }
        export namespace blinks {
            let at_143: number;
            export { at_143 as at };
            let type_141: string;
            export { type_141 as type };
        }
        export namespace yawns {
            let at_144: number;
            export { at_144 as at };
            let type_142: string;
            export { type_142 as type };
        }
        export namespace nods {
            let at_145: number;
            export { at_145 as at };
            let type_143: string;
            export { type_143 as type };
        }
        export namespace mouthOpenUs {
            let at_146: number;
            export { at_146 as at };
            let type_144: string;
            export { type_144 as type };
        }
        export namespace zone {
            let at_147: number;
            export { at_147 as at };
            let type_145: string;
            export { type_145 as type };
        }
        export namespace zoneUs {
            let at_148: number;
            export { at_148 as at };
            let type_146: string;
            export { type_146 as type };
        }
        export namespace awayUs {
            let at_149: number;
            export { at_149 as at };
            let type_147: string;
            export { type_147 as type };
        }
        export namespace away30Us {
            let at_150: number;
            export { at_150 as at };
            let type_148: string;
            export { type_148 as type };
        }
        export namespace naturalIsFinal {
            let at_151: number;
            export { at_151 as at };
            let type_149: string;
            export { type_149 as type };
        }
        export namespace fromRoadDeg {
            let at_152: number;
            export { at_152 as at };
            let type_150: string;
            export { type_150 as type };
            let count_25: number;
            export { count_25 as count };
        }
        export namespace naturalDeg {
            let at_153: number;
            export { at_153 as at };
            let type_151: string;
            export { type_151 as type };
            let count_26: number;
            export { count_26 as count };
        }
        export namespace openEye {
            let at_154: number;
            export { at_154 as at };
            let type_152: string;
            export { type_152 as type };
            let count_27: number;
            export { count_27 as count };
        }
        export namespace openEyeIsFinal {
            let at_155: number;
            export { at_155 as at };
            let type_153: string;
            export { type_153 as type };
        }
        export namespace drowsiness {
            let at_156: number;
            export { at_156 as at };
            let type_154: string;
            export { type_154 as type };
        }
        export namespace degraded {
            let at_157: number;
            export { at_157 as at };
            let type_155: string;
            export { type_155 as type };
        }
        export namespace reserved_2 {
            let at_158: number;
            export { at_158 as at };
            let type_156: string;
            export { type_156 as type };
        }
        export { reserved_2 as reserved };
        export namespace zonesUs {
            let at_159: number;
            export { at_159 as at };
            let type_157: string;
            export { type_157 as type };
            let count_28: number;
            export { count_28 as count };
        }
        export namespace perclos60 {
            let at_160: number;
            export { at_160 as at };
            export { PERCLOS as struct };
        }
        export namespace perclos180 {
            let at_161: number;
            export { at_161 as at };
            export { PERCLOS as struct };
        }
    }
    export { fields_13 as fields };
}
export namespace MONITOR_EVENT {
    let size_14: number;
    export { size_14 as size };
    export namespace fields_14 {
        export namespace timestampUs_4 {
            let at_162: number;
            export { at_162 as at };
            let type_158: string;
            export { type_158 as type };
        }
        export { timestampUs_4 as timestampUs };
        export namespace startUs {
            let at_163: number;
            export { at_163 as at };
            let type_159: string;
            export { type_159 as type };
        }
        export namespace durationUs {
            let at_164: number;
            export { at_164 as at };
            let type_160: string;
            export { type_160 as type };
        }
        export namespace kind_1 {
            let at_165: number;
            export { at_165 as at };
            let type_161: string;
            export { type_161 as type };
        }
        export { kind_1 as kind };
        export namespace zone_1 {
            let at_166: number;
            export { at_166 as at };
            let type_162: string;
            export { type_162 as type };
        }
        export { zone_1 as zone };
        export namespace flags_3 {
            let at_167: number;
            export { at_167 as at };
            let type_163: string;
            export { type_163 as type };
        }
        export { flags_3 as flags };
        export namespace value {
            let at_168: number;
            export { at_168 as at };
            let type_164: string;
            export { type_164 as type };
        }
        export namespace reserved_3 {
            let at_169: number;
            export { at_169 as at };
            let type_165: string;
            export { type_165 as type };
        }
        export { reserved_3 as reserved };
    }
    export { fields_14 as fields };
}
export namespace ZONE {
    let size_15: number;
    export { size_15 as size };
    export namespace fields_15 {
        export namespace kind_2 {
            let at_170: number;
            export { at_170 as at };
            let type_166: string;
            export { type_166 as type };
        }
        export { kind_2 as kind };
        export namespace flags_4 {
            let at_171: number;
            export { at_171 as at };
            let type_167: string;
            export { type_167 as type };
        }
        export { flags_4 as flags };
        export namespace graceUs {
            let at_172: number;
            export { at_172 as at };
            let type_168: string;
            export { type_168 as type };
        }
        export namespace numbers {
            let at_173: number;
            export { at_173 as at };
            let type_169: string;
            export { type_169 as type };
            let count_29: number;
            export { count_29 as count };
        }
    }
    export { fields_15 as fields };
}
export type State = (typeof STATES)[number];
export type Loss = (typeof LOSSES)[number];
export type EventKind = (typeof EVENTS)[number];
export type LensModel = (typeof LENSES)[number];
/**
 * A camera without its lens, in pixels of the upright image. All four 0 select the default: a
 *   horizontal field of view of 60 degrees and the principal point at the image centre. This struct
 *   never grows.
 */
export type Intrinsics = {
    /**
     * Focal lengths [px], 1..1000000; fy is 0.1..10 times fx.
     */
    fx: number;
    /**
     * Focal lengths [px], 1..1000000; fy is 0.1..10 times fx.
     */
    fy: number;
    /**
     * Principal point [px], -100000..100000.
     */
    cx: number;
    /**
     * Principal point [px], -100000..100000.
     */
    cy: number;
};
/**
 * The distortion of a lens. Landmarks and boxes stay in the picture as the lens shows it; pose and
 *   points in mm are those without it. This struct never grows.
 */
export type Lens = {
    /**
     * POSEWISE_LENS_*.
     */
    model: LensModel;
    /**
     * With POSEWISE_LENS_BROWN,
     * Brown-Conrady, x and y at unit depth and s = x^2 + y^2: x times (1 + k1 s + k2 s^2 + k3 s^3)
     * plus 2 p1 x y + p2 (s + 2 x^2), y likewise with p1 and p2 swapped; k1, k2, k3 are
     * -10000..10000, p1, p2 -0.1..0.1. With POSEWISE_LENS_FISHEYE, Kannala-Brandt, a point at the
     * angle t from the axis is at t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8); all are -10..10. The
     * picture must not turn back within 1 degree of the axis.
     */
    coefficients: [number, number, number, number, number];
};
/**
 * Settings. A NULL pointer to this struct selects all defaults.
 */
export type Config = {
    /**
     * Least width of a face to search for [px], 24..4096. 0: the
     * default, 40.
     */
    minFacePx?: number | undefined;
    /**
     * Work per step while searching, 100..10000000: 3000 is about a
     * tracking step, 600 is one tile of the detector. A smaller budget shortens a step and delays
     * detection. 0: the default, 3600.
     */
    scanBudget?: number | undefined;
    /**
     * The camera; see posewise_set_intrinsics().
     */
    intrinsics?: Intrinsics | undefined;
    /**
     * Parameters of the One-Euro filter behind posewise_smoothed()
     * (Casiez et al., CHI 2012). smoothing_hz: cutoff frequency at rest [Hz], 0.01..100; lower values
     * reduce jitter. smoothing_beta: increase of the cutoff per unit of speed, up to 1000; higher
     * values reduce lag. Speed is in face widths, radians or weights per second. 0: the defaults, 1
     * and 12.
     */
    smoothingHz?: number | undefined;
    /**
     * Parameters of the One-Euro filter behind posewise_smoothed()
     * (Casiez et al., CHI 2012). smoothing_hz: cutoff frequency at rest [Hz], 0.01..100; lower values
     * reduce jitter. smoothing_beta: increase of the cutoff per unit of speed, up to 1000; higher
     * values reduce lag. Speed is in face widths, radians or weights per second. 0: the defaults, 1
     * and 12.
     */
    smoothingBeta?: number | undefined;
    /**
     * The lens of the camera; other than POSEWISE_LENS_PINHOLE only with
     * intrinsics.
     */
    lens?: Lens | undefined;
    /**
     * 1: look at the eyes of the tracked face, which fills
     * eye_open_probability to eye_look of posewise_result. It takes more time: a network for each
     * eye. 0: those fields stay 0. 2: the same for a person who looks straight ahead most of the
     * time, as a driver does: part of the mean of the gaze in the head frame is taken off it, at most
     * 8 degrees.
     */
    gaze?: number | undefined;
};
/**
 * The result of one frame. Every number is finite.
 */
export type Result = {
    /**
     * POSEWISE_SEARCHING, POSEWISE_TRACKING or POSEWISE_COASTING.
     */
    state: State;
    /**
     * Capture time of the frame [us], as given in posewise_frame.
     */
    timestampUs: number;
    /**
     * Time since the frame of the last fit [us]; 0 while tracking.
     */
    ageUs: number;
    /**
     * Number of landmarks that posewise_landmarks() gives: 68; 0 while
     * searching.
     */
    landmarkCount: number;
    /**
     * Calibrated probability that this is a face whose landmarks are
     * right, 0..1. Right: the mean error is below a tenth of the distance between the outer eye
     * corners. In a library built without the verifier: goodness of fit of the 3D face, 0..1, not a
     * probability.
     */
    confidence: number;
    /**
     * Bounding box of the landmarks: x, y, width,
     * height [px].
     */
    faceBox: [number, number, number, number];
    /**
     * Head-to-camera rotation as a unit
     * quaternion x, y, z, w.
     */
    rotation: [number, number, number, number];
    /**
     * The rotation as angles relative to the camera's axes [deg]. yaw > 0:
     * the face turns to the image right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0:
     * the face tilts clockwise in the image, -180..180.
     */
    yawDeg: number;
    /**
     * The rotation as angles relative to the camera's axes [deg]. yaw > 0:
     * the face turns to the image right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0:
     * the face tilts clockwise in the image, -180..180.
     */
    pitchDeg: number;
    /**
     * The rotation as angles relative to the camera's axes [deg]. yaw > 0:
     * the face turns to the image right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0:
     * the face tilts clockwise in the image, -180..180.
     */
    rollDeg: number;
    /**
     * Origin of the head frame, midway between the
     * eyeballs, in the camera frame [mm].
     */
    translationMm: [number, number, number];
    /**
     * Eye opening, the person's left and right eye: 0 shut .. 1
     * open, -1 unknown because the eye is hidden or moves too fast.
     */
    eyeOpen: [number, number];
    /**
     * POSEWISE_LOSS_*: why tracking was lost, while coasting or searching.
     */
    loss: Loss;
    /**
     * Mean visibility of the landmarks, 0..1: low when much of the face
     * is occluded.
     */
    visibleShare: number;
    /**
     * Standard deviations of the rotation about
     * the camera's x, y and z axes [deg], as measured on rendered heads, by how the face is turned
     * and how much of it is seen. At most 180. Without intrinsics they hold the unknown focal length.
     */
    rotationSigmaDeg: [number, number, number];
    /**
     * Standard deviations of translation_mm
     * [mm], estimated likewise. At most 100000.
     */
    translationSigmaMm: [number, number, number];
    /**
     * Calibrated probability that the person's left and
     * right eye is open, 0..1, by a network that sees one eye at a time; -1 where eye_unknown has
     * another reason than POSEWISE_EYE_UNCERTAIN. This and all below is 0 unless state is
     * POSEWISE_TRACKING and posewise_config has gaze, and with a model without that network.
     */
    eyeOpenProbability: [number, number];
    /**
     * POSEWISE_EYE_*: why the lids of the left and right eye
     * are unknown, or POSEWISE_EYE_KNOWN. With POSEWISE_EYE_UNCERTAIN there is a probability.
     */
    eyeUnknown: [number, number];
    /**
     * Middle of the iris [px of the upright image]: x, y; that of
     * the landmarks of the eye where its gaze is unknown.
     */
    irisLeft: [number, number];
    /**
     * Middle of the iris [px of the upright image]: x, y; that
     * of the landmarks of the eye where its gaze is unknown.
     */
    irisRight: [number, number];
    /**
     * POSEWISE_EYE_*: why the gaze of the left eye,
     * the right eye and both together is unknown, or POSEWISE_EYE_KNOWN. The numbers below are 0
     * where it is unknown.
     */
    gazeUnknown: [number, number, number];
    /**
     * Standard deviations of these gazes along each
     * axis across them [deg].
     */
    gazeSigmaDeg: [number, number, number];
    /**
     * Unit directions in which the left eye, the right
     * eye and both together look, camera frame.
     */
    gazeLeft: [number, number, number];
    /**
     * Unit directions in which the left eye, the right
     * eye and both together look, camera frame.
     */
    gazeRight: [number, number, number];
    /**
     * Unit directions in which the left eye, the right eye
     * and both together look, camera frame.
     */
    gaze: [number, number, number];
    /**
     * That of both in the head frame: (0, 0, -1) is
     * straight ahead.
     */
    gazeHead: [number, number, number];
    /**
     * Probability that the person wears glasses, 0..1; -1 where neither eye
     * is seen.
     */
    glasses: number;
    /**
     * Probability that these are dark, 0..1; -1 where neither eye is
     * seen.
     */
    darkGlasses: number;
    /**
     * ARKit's
     * weights of the gaze, 0..1: eyeLookUpLeft, UpRight, DownLeft, DownRight, InLeft, InRight,
     * OutLeft, OutRight; 0 where it is unknown.
     */
    eyeLook: [number, number, number, number, number, number, number, number];
    /**
     * Facing: the rotation relative to the line from the face to the
     * camera [deg]. All 0: the face looks into the lens, wherever in the picture it is. Signs and
     * ranges as of yaw_deg, pitch_deg and roll_deg, which are relative to the camera's axes. These
     * hardly depend on the focal length; use them where it is not known.
     */
    facingYawDeg: number;
    /**
     * Facing: the rotation relative to the line from the face to the
     * camera [deg]. All 0: the face looks into the lens, wherever in the picture it is. Signs and
     * ranges as of yaw_deg, pitch_deg and roll_deg, which are relative to the camera's axes. These
     * hardly depend on the focal length; use them where it is not known.
     */
    facingPitchDeg: number;
    /**
     * Facing: the rotation relative to the line from the face to the
     * camera [deg]. All 0: the face looks into the lens, wherever in the picture it is. Signs and
     * ranges as of yaw_deg, pitch_deg and roll_deg, which are relative to the camera's axes. These
     * hardly depend on the focal length; use them where it is not known.
     */
    facingRollDeg: number;
    /**
     * Standard deviations of the facing yaw, pitch
     * and roll [deg]. At most 180.
     */
    facingSigmaDeg: [number, number, number];
    /**
     * Focal length along x with which the face was fitted [px].
     */
    focalPx: number;
    /**
     * 1: without intrinsics, 60 degrees across the frame were assumed.
     * 0: the tracker has them.
     */
    cameraAssumed: number;
};
/**
 * Where a face is expected, for posewise_step_at(): found by another detector, or by a tracker of
 *   another camera.
 */
export type Hint = {
    /**
     * Box of the landmarks in the upright image:
     * x, y, width, height [px]. It reaches from the brows to below the chin and from ear to ear;
     * boxes of whole heads are larger. The longer side is at least 16.
     */
    faceBox: [number, number, number, number];
    /**
     * As facing_yaw_deg of posewise_result [deg], 0 where it is not known.
     */
    yawDeg?: number | undefined;
    /**
     * Roll [deg] as in posewise_result, 0 where it is not known.
     */
    rollDeg?: number | undefined;
};
/**
 * A face of a frame, from posewise_detect(). This struct never grows.
 */
export type Face = {
    /**
     * Box of the landmarks in the upright image:
     * x, y, width, height [px].
     */
    faceBox: [number, number, number, number];
    /**
     * As facing_yaw_deg of posewise_result [deg]; rough.
     */
    yawDeg: number;
    /**
     * Roll [deg] as in posewise_result.
     */
    rollDeg: number;
    /**
     * As in posewise_result. In a library built without the verifier:
     * always 1.
     */
    confidence: number;
};
/**
 * One landmark. This struct never grows, so the layout of arrays stays the same.
 */
export type Landmark = {
    /**
     * Position in the upright image [px]. Points 0..16 follow the visible contour
     * of the jaw. The others are images of x_mm, y_mm, z_mm; hidden ones are estimated from the rest.
     */
    x: number;
    /**
     * Position in the upright image [px]. Points 0..16 follow the visible contour
     * of the jaw. The others are images of x_mm, y_mm, z_mm; hidden ones are estimated from the rest.
     */
    y: number;
    /**
     * Calibrated probability that the error of (x, y) is below a tenth of
     * the distance between the outer eye corners of the same face seen from the front, 0..1.
     */
    confidence: number;
    /**
     * Calibrated probability that the landmark is visible, 0..1: neither
     * the head itself nor anything in front of it hides it. In a library built without the verifier:
     * 0 where the head itself hides it, else 1; the landmark's confidence is then that of the face.
     */
    visibility: number;
    /**
     * Point of the 3D face in the camera frame [mm]; for points 0..16 a fixed
     * point of the jaw.
     */
    xMm: number;
    /**
     * Point of the 3D face in the camera frame [mm]; for points 0..16 a fixed
     * point of the jaw.
     */
    yMm: number;
    /**
     * Point of the 3D face in the camera frame [mm]; for points 0..16 a fixed
     * point of the jaw.
     */
    zMm: number;
};
/**
 * An event of the log that posewise_events() reads. confidence and face_box are those of the fit
 *   that was accepted, or the last ones of the face that is lost; 0 where there is no face. This
 *   struct never grows, so the layout of arrays stays the same. Later libraries may have kinds that
 *   this header lacks.
 */
export type FaceEvent = {
    /**
     * Capture time of the frame [us]; of a call between two frames, that
     * of the first.
     */
    timestampUs: number;
    /**
     * POSEWISE_EVENT_*.
     */
    kind: EventKind;
    /**
     * POSEWISE_LOSS_*: why the face is lost; while searching, why the last one
     * was.
     */
    loss: Loss;
    /**
     * Bounding box of the landmarks: x, y, width,
     * height [px].
     */
    faceBox: [number, number, number, number];
    /**
     * As in posewise_result.
     */
    confidence: number;
};
/**
 * A region of interest for posewise_set_roi(): a rectangle of the upright image [px]. All four 0:
 *   the whole frame. This struct never grows.
 */
export type Roi = {
    /**
     * Upper left corner.
     */
    x: number;
    /**
     * Upper left corner.
     */
    y: number;
    /**
     * Width and height, at least 1; x + width and y + height are at most
     * 16384.
     */
    width: number;
    /**
     * Width and height, at least 1; x + width and y + height are at most
     * 16384.
     */
    height: number;
};
/**
 * Settings of a driver monitor. A NULL pointer to this struct selects all defaults; 0 in a field
 *   selects that of the preset, of which the comments have the general one. Times are at most 71
 *   minutes.
 */
export type Monitor_config = {
    /**
     * POSEWISE_PRESET_*: the default of every other field, and the zones.
     */
    preset: number;
    /**
     * How long an observation counts when no other follows, and how long what
     * goes on survives unknown time [us], 100000..2000000. Default 300000, the gap that arbiters of
     * driver monitors bridge.
     */
    gapUs: number;
    /**
     * Least confidence of a face that is observed, 0..1. Default 0.5,
     * chosen.
     */
    minConfidence: number;
    /**
     * Largest angles from the line of sight at which eyes and mouth are
     * known [deg], 10..90. Defaults 50 and 40, chosen: beyond, lids are seen too much from the side.
     */
    eyeYawDeg: number;
    /**
     * Largest angles from the line of sight at which eyes and mouth are
     * known [deg], 10..90. Defaults 50 and 40, chosen: beyond, lids are seen too much from the side.
     */
    eyePitchDeg: number;
    /**
     * Eyes close below the first openness and open above the second,
     * 0.05..0.95. Defaults 0.35 and 0.45, chosen on rendered clips.
     */
    closedBelow: number;
    /**
     * Eyes close below the first openness and open above the second,
     * 0.05..0.95. Defaults 0.35 and 0.45, chosen on rendered clips.
     */
    openAbove: number;
    /**
     * Shorter closures are no events [us]. Default 50000, chosen: a blink
     * takes 100 to 400 ms.
     */
    blinkUs: number;
    /**
     * A longer closure is no blink [us]. Default 500000, as in studies
     * of blinks.
     */
    longClosureUs: number;
    /**
     * Closures of these lengths are a microsleep, sleep, an
     * unresponsive driver [us]. Defaults 1000000, 3000000, 6000000: Euro NCAP 2026.
     */
    microsleepUs: number;
    /**
     * Closures of these lengths are a microsleep, sleep, an unresponsive
     * driver [us]. Defaults 1000000, 3000000, 6000000: Euro NCAP 2026.
     */
    sleepUs: number;
    /**
     * Closures of these lengths are a microsleep, sleep, an
     * unresponsive driver [us]. Defaults 1000000, 3000000, 6000000: Euro NCAP 2026.
     */
    unresponsiveUs: number;
    /**
     * Drowsy from these P80 over 60 and 180 s, 0.01..1. Defaults 0.15
     * (Wierwille 1994; NSTSCE 25-UI-177) and 0.12 (NHTSA and VTTI, DOT HS 811 117).
     */
    drowsyP8060: number;
    /**
     * Drowsy from these P80 over 60 and 180 s, 0.01..1. Defaults 0.15
     * (Wierwille 1994; NSTSCE 25-UI-177) and 0.12 (NHTSA and VTTI, DOT HS 811 117).
     */
    drowsyP80180: number;
    /**
     * Awake below this share of both, 0.1..1. Default 0.5: Wierwille
     * 1994, 7.5 and 15 %.
     */
    awakeShare: number;
    /**
     * Least known share of a window that decides, 0.05..1. Default 0.5,
     * chosen.
     */
    minKnown: number;
    /**
     * The mouth is open for a yawn above the first jaw_open and shut below
     * the second, up to 0.95. Defaults 0.5 (studies of mouth ratios have 0.5 to 0.6) and 0.35,
     * chosen.
     */
    yawnAbove: number;
    /**
     * The mouth is open for a yawn above the first jaw_open and shut below
     * the second, up to 0.95. Defaults 0.5 (studies of mouth ratios have 0.5 to 0.6) and 0.35,
     * chosen.
     */
    yawnBelow: number;
    /**
     * Shortest and longest yawn [us]. Defaults 1500000 and 12000000, from
     * studies of yawns.
     */
    yawnUs: number;
    /**
     * Shortest and longest yawn [us]. Defaults 1500000 and 12000000, from
     * studies of yawns.
     */
    yawnMaxUs: number;
    /**
     * A nod is a drop of the pitch by nod_deg within a second, 5..60, and a
     * return within nod_us, at least a second, with closed eyes. Defaults 12 [deg] and 3000000 [us],
     * from studies.
     */
    nodDeg: number;
    /**
     * A nod is a drop of the pitch by nod_deg within a second, 5..60, and a
     * return within nod_us, at least a second, with closed eyes. Defaults 12 [deg] and 3000000 [us],
     * from studies.
     */
    nodUs: number;
    /**
     * Direction of the road: yaw (-90..90) and pitch (-60..60) of a
     * face that looks there, in the camera frame [deg]. Default 0 and 0.
     */
    forwardYawDeg: number;
    /**
     * Direction of the road: yaw (-90..90) and pitch (-60..60) of a
     * face that looks there, in the camera frame [deg]. Default 0 and 0.
     */
    forwardPitchDeg: number;
    /**
     * How far the driver's natural pose may be from there [deg], up to
     * 50 and 30. Defaults 45 and 25, for cameras up to 40 degrees off the driver's axis.
     */
    naturalYawDeg: number;
    /**
     * How far the driver's natural pose may be from there [deg], up
     * to 50 and 30. Defaults 45 and 25, for cameras up to 40 degrees off the driver's axis.
     */
    naturalPitchDeg: number;
    /**
     * A zone is left this far outside of it [deg], up to 15. Default
     * 3, chosen: the error of a pose.
     */
    zoneMarginDeg: number;
    /**
     * A glance away of this length is long [us]. Default 3000000: Euro
     * NCAP 2026, 3 to 4 s.
     */
    longGlanceUs: number;
    /**
     * So much of the last 30 s away is too much [us], up to 30000000.
     * Default 10000000: Euro NCAP 2026.
     */
    cumulativeUs: number;
    /**
     * Time on the road that ends a glance [us]. Default 300000, as gap_us.
     */
    returnUs: number;
    /**
     * Time on the road that clears the time away [us]. Default 2000000: Euro
     * NCAP 2026.
     */
    clearUs: number;
    /**
     * Eyes that are unknown for this long are reported [us]. Default
     * 10000000: Euro NCAP 2026.
     */
    degradedUs: number;
};
/**
 * What a driver monitor sees of one frame, from posewise_observe() or from elsewhere. Numbers that
 *   are not finite are unknown.
 */
export type Observation = {
    /**
     * As in posewise_result. Only POSEWISE_TRACKING is a face that is
     * observed.
     */
    state: number;
    /**
     * As in posewise_result.
     */
    confidence: number;
    /**
     * As in posewise_result [deg].
     */
    yawDeg: number;
    /**
     * As in posewise_result [deg].
     */
    pitchDeg: number;
    /**
     * As in posewise_result [mm].
     */
    translationMm: [number, number, number];
    /**
     * As in posewise_result [deg].
     */
    rotationSigmaDeg: [number, number, number];
    /**
     * Distance of the lids in that of open ones, of the person's
     * left and right eye, 0 shut .. 1 open, -1 unknown; posewise_observe computes it from
     * posewise_result.eye_open and what the gaze says of the eyes.
     */
    eyeOpen: [number, number];
    /**
     * The animation weight jawOpen, 0..1; -1: unknown, because the mouth is
     * hidden.
     */
    jawOpen: number;
    /**
     * As in posewise_result. 1: the natural pose is learnt, and angles
     * from the road count, relative to the line of sight, which hardly depends on the focal length;
     * not with POSEWISE_MONITOR_FIXED_POSE.
     */
    cameraAssumed: number;
};
/**
 * Measures of eye closure over a window of whole seconds. This struct never grows.
 */
export type Perclos = {
    /**
     * Shares of the known time with eyes closed by at least 70 and 80 %, 0..1.
     */
    p70: number;
    /**
     * Shares of the known time with eyes closed by at least 70 and 80 %, 0..1.
     */
    p80: number;
    /**
     * Mean square of the closure over the known time, 0..1.
     */
    em: number;
    /**
     * Share of the window in which the eyes were known, 0..1.
     */
    known: number;
    /**
     * Closures that ended in the window, blinks too, and their mean length
     * [us].
     */
    closures: number;
    /**
     * Closures that ended in the window, blinks too, and their mean
     * length [us].
     */
    meanClosureUs: number;
};
/**
 * What a driver monitor knows after an observation.
 */
export type Monitor_state = {
    /**
     * POSEWISE_EYES_*.
     */
    eyes: number;
    /**
     * Timestamp of the last observation [us].
     */
    timestampUs: number;
    /**
     * POSEWISE_UNKNOWN_*: why the eyes are unknown.
     */
    eyesUnknown: number;
    /**
     * Both eyes, relative to this person's open ones: 0 shut .. 1 open, -1
     * unknown.
     */
    openness: number;
    /**
     * Known closed time of the closure that goes on [us].
     */
    closureUs: number;
    /**
     * Blinks, yawns and nods so far.
     */
    blinks: number;
    /**
     * Blinks, yawns and nods so far.
     */
    yawns: number;
    /**
     * Blinks, yawns and nods so far.
     */
    nods: number;
    /**
     * Known time for which the mouth is open as in a yawn [us].
     */
    mouthOpenUs: number;
    /**
     * Index of the zone, POSEWISE_ZONE_OUTSIDE or POSEWISE_ZONE_UNKNOWN.
     */
    zone: number;
    /**
     * Time there [us].
     */
    zoneUs: number;
    /**
     * Known time away from the road, less the grace of zones, in this glance
     * [us].
     */
    awayUs: number;
    /**
     * The same in the last 30 s [us]: the current quarter of a second and
     * the 119 before.
     */
    away30Us: number;
    /**
     * 1: natural_deg is final, after a minute of known pose. Before
     * the first 10 s of it, the zone is unknown.
     */
    naturalIsFinal: number;
    /**
     * Yaw and pitch from the direction of the road [deg]; 0
     * for an unknown zone.
     */
    fromRoadDeg: [number, number];
    /**
     * The natural pose: yaw and pitch from forward_yaw_deg and
     * forward_pitch_deg [deg].
     */
    naturalDeg: [number, number];
    /**
     * posewise_observation.eye_open of this person's open left and
     * right eye; 1 until it is final.
     */
    openEye: [number, number];
    /**
     * 1: open_eye is final, after half a minute of known eyes while
     * alert.
     */
    openEyeIsFinal: number;
    /**
     * POSEWISE_LEVEL_*.
     */
    drowsiness: number;
    /**
     * 1: the eyes have been unknown for degraded_us.
     */
    degraded: number;
    /**
     * Known time
     * in each zone so far [us].
     */
    zonesUs: [number, number, number, number, number, number, number, number];
    /**
     * Measures over the last 60 and 180 whole seconds since the first
     * observation. They change once a second.
     */
    perclos60: number;
    /**
     * Measures over the last 60 and 180 whole seconds since the first
     * observation. They change once a second.
     */
    perclos180: number;
};
/**
 * An event of posewise_monitor_events(). This struct never grows, so the layout of arrays stays the
 *   same. Later libraries may have kinds that this header lacks.
 */
export type Monitor_event = {
    /**
     * Timestamp of the observation at which it was noticed [us].
     */
    timestampUs: number;
    /**
     * Timestamp at which what it is about began [us].
     */
    startUs: number;
    /**
     * Known duration of it so far [us], without what was unknown in
     * between.
     */
    durationUs: number;
    /**
     * POSEWISE_DRIVER_*.
     */
    kind: number;
    /**
     * Zone of a glance, else POSEWISE_ZONE_UNKNOWN.
     */
    zone: number;
    /**
     * As the kind says, else 0.
     */
    value: number;
};
/**
 * A zone of a driver monitor. Where zones overlap, the first one counts. This struct never grows,
 *   so the layout of arrays stays the same.
 */
export type Zone = {
    /**
     * POSEWISE_ZONE_ANGLES, _BOX or _PLANE.
     */
    kind: number;
    /**
     * Time of a stay that does not count as away [us]; 0xFFFFFFFF: none of
     * it does.
     */
    graceUs: number;
    /**
     * As
     * the kind says, the rest 0. Angles are those from the direction of the road, within -180..180:
     * yaw > 0 to the image right, pitch > 0 up. Boxes, along the axes, and planes, the parallelogram
     * centre +- u +- v, are in the camera frame, within -20000..20000 mm.
     */
    numbers: [number, number, number, number, number, number, number, number, number];
};
