// While developing, Vite packs packages anew, and leaves their workers behind.
export default {
  base: './',
  build: { target: 'es2022' },
  logLevel: 'warn',
  optimizeDeps: { exclude: ['posewise'] },
};
