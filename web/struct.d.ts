/**
 * The struct at an address, as an object.
 * @param {DataView} view
 * @param {number} start
 * @param {Layout} layout
 * @returns {any}
 */
export function readStruct(view: DataView, start: number, layout: Layout): any;
/**
 * Writes an object as the struct at an address. Fields that it lacks become 0.
 * @param {DataView} view
 * @param {number} start
 * @param {Layout} layout
 * @param {Record<string, any>} object
 */
export function writeStruct(view: DataView, start: number, layout: Layout, object: Record<string, any>): void;
/**
 * Where a field is: a number or a struct, once or several times.
 */
export type Place = {
    /**
     * Offset from the start of the struct [bytes].
     */
    at: number;
    /**
     * `u32`, `i64` or `f32`; a number.
     */
    type?: string | undefined;
    /**
     * A struct.
     */
    struct?: Layout | undefined;
    /**
     * Elements of an array.
     */
    count?: number | undefined;
    /**
     * Names of the field's values.
     */
    names?: readonly string[] | undefined;
};
export type Layout = {
    /**
     * Size of the struct [bytes].
     */
    size: number;
    fields: Record<string, Place>;
};
