var Ge,w,en,Ke,ae,Zt,tn,nn,sn,wt,bt,yt,_s,Te={},on=[],$s=/acit|ex(?:s|g|n|p|$)|rph|grid|ows|mnc|ntw|ine[ch]|zoo|^ord|itera/i,Je=Array.isArray;function Y(e,t){for(var n in t)e[n]=t[n];return e}function xt(e){e&&e.parentNode&&e.parentNode.removeChild(e)}function Ze(e,t,n){var s,o,i,r={};for(i in t)i=="key"?s=t[i]:i=="ref"?o=t[i]:r[i]=t[i];if(arguments.length>2&&(r.children=arguments.length>3?Ge.call(arguments,2):n),typeof e=="function"&&e.defaultProps!=null)for(i in e.defaultProps)r[i]===void 0&&(r[i]=e.defaultProps[i]);return Be(e,r,s,o,null)}function Be(e,t,n,s,o){var i={type:e,props:t,key:n,ref:s,__k:null,__:null,__b:0,__e:null,__c:null,constructor:void 0,__v:o??++en,__i:-1,__u:0};return o==null&&w.vnode!=null&&w.vnode(i),i}function Xe(e){return e.children}function le(e,t){this.props=e,this.context=t}function ge(e,t){if(t==null)return e.__?ge(e.__,e.__i+1):null;for(var n;t<e.__k.length;t++)if((n=e.__k[t])!=null&&n.__e!=null)return n.__e;return typeof e.type=="function"?ge(e):null}function rn(e){var t,n;if((e=e.__)!=null&&e.__c!=null){for(e.__e=e.__c.base=null,t=0;t<e.__k.length;t++)if((n=e.__k[t])!=null&&n.__e!=null){e.__e=e.__c.base=n.__e;break}return rn(e)}}function Xt(e){(!e.__d&&(e.__d=!0)&&ae.push(e)&&!Ve.__r++||Zt!=w.debounceRendering)&&((Zt=w.debounceRendering)||tn)(Ve)}function Ve(){for(var e,t,n,s,o,i,r,c=1;ae.length;)ae.length>c&&ae.sort(nn),e=ae.shift(),c=ae.length,e.__d&&(n=void 0,o=(s=(t=e).__v).__e,i=[],r=[],t.__P&&((n=Y({},s)).__v=s.__v+1,w.vnode&&w.vnode(n),kt(t.__P,n,s,t.__n,t.__P.namespaceURI,32&s.__u?[o]:null,i,o??ge(s),!!(32&s.__u),r),n.__v=s.__v,n.__.__k[n.__i]=n,cn(i,n,r),n.__e!=o&&rn(n)));Ve.__r=0}function an(e,t,n,s,o,i,r,c,d,l,p){var u,h,f,v,m,_,g=s&&s.__k||on,y=t.length;for(d=gs(n,t,g,d,y),u=0;u<y;u++)(f=n.__k[u])!=null&&(h=f.__i==-1?Te:g[f.__i]||Te,f.__i=u,_=kt(e,f,h,o,i,r,c,d,l,p),v=f.__e,f.ref&&h.ref!=f.ref&&(h.ref&&St(h.ref,null,f),p.push(f.ref,f.__c||v,f)),m==null&&v!=null&&(m=v),4&f.__u||h.__k===f.__k?d=ln(f,d,e):typeof f.type=="function"&&_!==void 0?d=_:v&&(d=v.nextSibling),f.__u&=-7);return n.__e=m,d}function gs(e,t,n,s,o){var i,r,c,d,l,p=n.length,u=p,h=0;for(e.__k=new Array(o),i=0;i<o;i++)(r=t[i])!=null&&typeof r!="boolean"&&typeof r!="function"?(d=i+h,(r=e.__k[i]=typeof r=="string"||typeof r=="number"||typeof r=="bigint"||r.constructor==String?Be(null,r,null,null,null):Je(r)?Be(Xe,{children:r},null,null,null):r.constructor==null&&r.__b>0?Be(r.type,r.props,r.key,r.ref?r.ref:null,r.__v):r).__=e,r.__b=e.__b+1,c=null,(l=r.__i=bs(r,n,d,u))!=-1&&(u--,(c=n[l])&&(c.__u|=2)),c==null||c.__v==null?(l==-1&&(o>p?h--:o<p&&h++),typeof r.type!="function"&&(r.__u|=4)):l!=d&&(l==d-1?h--:l==d+1?h++:(l>d?h--:h++,r.__u|=4))):e.__k[i]=null;if(u)for(i=0;i<p;i++)(c=n[i])!=null&&(2&c.__u)==0&&(c.__e==s&&(s=ge(c)),dn(c,c));return s}function ln(e,t,n){var s,o;if(typeof e.type=="function"){for(s=e.__k,o=0;s&&o<s.length;o++)s[o]&&(s[o].__=e,t=ln(s[o],t,n));return t}e.__e!=t&&(t&&e.type&&!n.contains(t)&&(t=ge(e)),n.insertBefore(e.__e,t||null),t=e.__e);do t=t&&t.nextSibling;while(t!=null&&t.nodeType==8);return t}function bs(e,t,n,s){var o,i,r=e.key,c=e.type,d=t[n];if(d===null&&e.key==null||d&&r==d.key&&c==d.type&&(2&d.__u)==0)return n;if(s>(d!=null&&(2&d.__u)==0?1:0))for(o=n-1,i=n+1;o>=0||i<t.length;){if(o>=0){if((d=t[o])&&(2&d.__u)==0&&r==d.key&&c==d.type)return o;o--}if(i<t.length){if((d=t[i])&&(2&d.__u)==0&&r==d.key&&c==d.type)return i;i++}}return-1}function Qt(e,t,n){t[0]=="-"?e.setProperty(t,n??""):e[t]=n==null?"":typeof n!="number"||$s.test(t)?n:n+"px"}function qe(e,t,n,s,o){var i,r;e:if(t=="style")if(typeof n=="string")e.style.cssText=n;else{if(typeof s=="string"&&(e.style.cssText=s=""),s)for(t in s)n&&t in n||Qt(e.style,t,"");if(n)for(t in n)s&&n[t]==s[t]||Qt(e.style,t,n[t])}else if(t[0]=="o"&&t[1]=="n")i=t!=(t=t.replace(sn,"$1")),r=t.toLowerCase(),t=r in e||t=="onFocusOut"||t=="onFocusIn"?r.slice(2):t.slice(2),e.l||(e.l={}),e.l[t+i]=n,n?s?n.u=s.u:(n.u=wt,e.addEventListener(t,i?yt:bt,i)):e.removeEventListener(t,i?yt:bt,i);else{if(o=="http://www.w3.org/2000/svg")t=t.replace(/xlink(H|:h)/,"h").replace(/sName$/,"s");else if(t!="width"&&t!="height"&&t!="href"&&t!="list"&&t!="form"&&t!="tabIndex"&&t!="download"&&t!="rowSpan"&&t!="colSpan"&&t!="role"&&t!="popover"&&t in e)try{e[t]=n??"";break e}catch{}typeof n=="function"||(n==null||n===!1&&t[4]!="-"?e.removeAttribute(t):e.setAttribute(t,t=="popover"&&n==1?"":n))}}function Yt(e){return function(t){if(this.l){var n=this.l[t.type+e];if(t.t==null)t.t=wt++;else if(t.t<n.u)return;return n(w.event?w.event(t):t)}}}function kt(e,t,n,s,o,i,r,c,d,l){var p,u,h,f,v,m,_,g,y,ke,se,Le,Se,Jt,ze,Me,gt,G=t.type;if(t.constructor!=null)return null;128&n.__u&&(d=!!(32&n.__u),i=[c=t.__e=n.__e]),(p=w.__b)&&p(t);e:if(typeof G=="function")try{if(g=t.props,y="prototype"in G&&G.prototype.render,ke=(p=G.contextType)&&s[p.__c],se=p?ke?ke.props.value:p.__:s,n.__c?_=(u=t.__c=n.__c).__=u.__E:(y?t.__c=u=new G(g,se):(t.__c=u=new le(g,se),u.constructor=G,u.render=ws),ke&&ke.sub(u),u.props=g,u.state||(u.state={}),u.context=se,u.__n=s,h=u.__d=!0,u.__h=[],u._sb=[]),y&&u.__s==null&&(u.__s=u.state),y&&G.getDerivedStateFromProps!=null&&(u.__s==u.state&&(u.__s=Y({},u.__s)),Y(u.__s,G.getDerivedStateFromProps(g,u.__s))),f=u.props,v=u.state,u.__v=t,h)y&&G.getDerivedStateFromProps==null&&u.componentWillMount!=null&&u.componentWillMount(),y&&u.componentDidMount!=null&&u.__h.push(u.componentDidMount);else{if(y&&G.getDerivedStateFromProps==null&&g!==f&&u.componentWillReceiveProps!=null&&u.componentWillReceiveProps(g,se),!u.__e&&u.shouldComponentUpdate!=null&&u.shouldComponentUpdate(g,u.__s,se)===!1||t.__v==n.__v){for(t.__v!=n.__v&&(u.props=g,u.state=u.__s,u.__d=!1),t.__e=n.__e,t.__k=n.__k,t.__k.some(function(Ce){Ce&&(Ce.__=t)}),Le=0;Le<u._sb.length;Le++)u.__h.push(u._sb[Le]);u._sb=[],u.__h.length&&r.push(u);break e}u.componentWillUpdate!=null&&u.componentWillUpdate(g,u.__s,se),y&&u.componentDidUpdate!=null&&u.__h.push(function(){u.componentDidUpdate(f,v,m)})}if(u.context=se,u.props=g,u.__P=e,u.__e=!1,Se=w.__r,Jt=0,y){for(u.state=u.__s,u.__d=!1,Se&&Se(t),p=u.render(u.props,u.state,u.context),ze=0;ze<u._sb.length;ze++)u.__h.push(u._sb[ze]);u._sb=[]}else do u.__d=!1,Se&&Se(t),p=u.render(u.props,u.state,u.context),u.state=u.__s;while(u.__d&&++Jt<25);u.state=u.__s,u.getChildContext!=null&&(s=Y(Y({},s),u.getChildContext())),y&&!h&&u.getSnapshotBeforeUpdate!=null&&(m=u.getSnapshotBeforeUpdate(f,v)),Me=p,p!=null&&p.type===Xe&&p.key==null&&(Me=un(p.props.children)),c=an(e,Je(Me)?Me:[Me],t,n,s,o,i,r,c,d,l),u.base=t.__e,t.__u&=-161,u.__h.length&&r.push(u),_&&(u.__E=u.__=null)}catch(Ce){if(t.__v=null,d||i!=null)if(Ce.then){for(t.__u|=d?160:128;c&&c.nodeType==8&&c.nextSibling;)c=c.nextSibling;i[i.indexOf(c)]=null,t.__e=c}else for(gt=i.length;gt--;)xt(i[gt]);else t.__e=n.__e,t.__k=n.__k;w.__e(Ce,t,n)}else i==null&&t.__v==n.__v?(t.__k=n.__k,t.__e=n.__e):c=t.__e=ys(n.__e,t,n,s,o,i,r,d,l);return(p=w.diffed)&&p(t),128&t.__u?void 0:c}function cn(e,t,n){for(var s=0;s<n.length;s++)St(n[s],n[++s],n[++s]);w.__c&&w.__c(t,e),e.some(function(o){try{e=o.__h,o.__h=[],e.some(function(i){i.call(o)})}catch(i){w.__e(i,o.__v)}})}function un(e){return typeof e!="object"||e==null||e.__b&&e.__b>0?e:Je(e)?e.map(un):Y({},e)}function ys(e,t,n,s,o,i,r,c,d){var l,p,u,h,f,v,m,_=n.props,g=t.props,y=t.type;if(y=="svg"?o="http://www.w3.org/2000/svg":y=="math"?o="http://www.w3.org/1998/Math/MathML":o||(o="http://www.w3.org/1999/xhtml"),i!=null){for(l=0;l<i.length;l++)if((f=i[l])&&"setAttribute"in f==!!y&&(y?f.localName==y:f.nodeType==3)){e=f,i[l]=null;break}}if(e==null){if(y==null)return document.createTextNode(g);e=document.createElementNS(o,y,g.is&&g),c&&(w.__m&&w.__m(t,i),c=!1),i=null}if(y==null)_===g||c&&e.data==g||(e.data=g);else{if(i=i&&Ge.call(e.childNodes),_=n.props||Te,!c&&i!=null)for(_={},l=0;l<e.attributes.length;l++)_[(f=e.attributes[l]).name]=f.value;for(l in _)if(f=_[l],l!="children"){if(l=="dangerouslySetInnerHTML")u=f;else if(!(l in g)){if(l=="value"&&"defaultValue"in g||l=="checked"&&"defaultChecked"in g)continue;qe(e,l,null,f,o)}}for(l in g)f=g[l],l=="children"?h=f:l=="dangerouslySetInnerHTML"?p=f:l=="value"?v=f:l=="checked"?m=f:c&&typeof f!="function"||_[l]===f||qe(e,l,f,_[l],o);if(p)c||u&&(p.__html==u.__html||p.__html==e.innerHTML)||(e.innerHTML=p.__html),t.__k=[];else if(u&&(e.innerHTML=""),an(t.type=="template"?e.content:e,Je(h)?h:[h],t,n,s,y=="foreignObject"?"http://www.w3.org/1999/xhtml":o,i,r,i?i[0]:n.__k&&ge(n,0),c,d),i!=null)for(l=i.length;l--;)xt(i[l]);c||(l="value",y=="progress"&&v==null?e.removeAttribute("value"):v!=null&&(v!==e[l]||y=="progress"&&!v||y=="option"&&v!=_[l])&&qe(e,l,v,_[l],o),l="checked",m!=null&&m!=e[l]&&qe(e,l,m,_[l],o))}return e}function St(e,t,n){try{if(typeof e=="function"){var s=typeof e.__u=="function";s&&e.__u(),s&&t==null||(e.__u=e(t))}else e.current=t}catch(o){w.__e(o,n)}}function dn(e,t,n){var s,o;if(w.unmount&&w.unmount(e),(s=e.ref)&&(s.current&&s.current!=e.__e||St(s,null,t)),(s=e.__c)!=null){if(s.componentWillUnmount)try{s.componentWillUnmount()}catch(i){w.__e(i,t)}s.base=s.__P=null}if(s=e.__k)for(o=0;o<s.length;o++)s[o]&&dn(s[o],t,n||typeof e.type!="function");n||xt(e.__e),e.__c=e.__=e.__e=void 0}function ws(e,t,n){return this.constructor(e,n)}function Mt(e,t,n){var s,o,i,r;t==document&&(t=document.documentElement),w.__&&w.__(e,t),o=(s=typeof n=="function")?null:n&&n.__k||t.__k,i=[],r=[],kt(t,e=(!s&&n||t).__k=Ze(Xe,null,[e]),o||Te,Te,t.namespaceURI,!s&&n?[n]:o?null:t.firstChild?Ge.call(t.childNodes):null,i,!s&&n?n:o?o.__e:t.firstChild,s,r),cn(i,e,r)}Ge=on.slice,w={__e:function(e,t,n,s){for(var o,i,r;t=t.__;)if((o=t.__c)&&!o.__)try{if((i=o.constructor)&&i.getDerivedStateFromError!=null&&(o.setState(i.getDerivedStateFromError(e)),r=o.__d),o.componentDidCatch!=null&&(o.componentDidCatch(e,s||{}),r=o.__d),r)return o.__E=o}catch(c){e=c}throw e}},en=0,Ke=function(e){return e!=null&&e.constructor==null},le.prototype.setState=function(e,t){var n;n=this.__s!=null&&this.__s!=this.state?this.__s:this.__s=Y({},this.state),typeof e=="function"&&(e=e(Y({},n),this.props)),e&&Y(n,e),e!=null&&this.__v&&(t&&this._sb.push(t),Xt(this))},le.prototype.forceUpdate=function(e){this.__v&&(this.__e=!0,e&&this.__h.push(e),Xt(this))},le.prototype.render=Xe,ae=[],tn=typeof Promise=="function"?Promise.prototype.then.bind(Promise.resolve()):setTimeout,nn=function(e,t){return e.__v.__b-t.__v.__b},Ve.__r=0,sn=/(PointerCapture)$|Capture$/i,wt=0,bt=Yt(!1),yt=Yt(!0),_s=0;var fn=function(e,t,n,s){var o;t[0]=0;for(var i=1;i<t.length;i++){var r=t[i++],c=t[i]?(t[0]|=r?1:2,n[t[i++]]):t[++i];r===3?s[0]=c:r===4?s[1]=Object.assign(s[1]||{},c):r===5?(s[1]=s[1]||{})[t[++i]]=c:r===6?s[1][t[++i]]+=c+"":r?(o=e.apply(c,fn(e,c,n,["",null])),s.push(o),c[0]?t[0]|=2:(t[i-2]=0,t[i]=o)):s.push(c)}return s},pn=new Map;function hn(e){var t=pn.get(this);return t||(t=new Map,pn.set(this,t)),(t=fn(this,t.get(e)||(t.set(e,t=function(n){for(var s,o,i=1,r="",c="",d=[0],l=function(h){i===1&&(h||(r=r.replace(/^\s*\n\s*|\s*\n\s*$/g,"")))?d.push(0,h,r):i===3&&(h||r)?(d.push(3,h,r),i=2):i===2&&r==="..."&&h?d.push(4,h,0):i===2&&r&&!h?d.push(5,0,!0,r):i>=5&&((r||!h&&i===5)&&(d.push(i,0,r,o),i=6),h&&(d.push(i,h,0,o),i=6)),r=""},p=0;p<n.length;p++){p&&(i===1&&l(),l(p));for(var u=0;u<n[p].length;u++)s=n[p][u],i===1?s==="<"?(l(),d=[d],i=3):r+=s:i===4?r==="--"&&s===">"?(i=1,r=""):r=s+r[0]:c?s===c?c="":r+=s:s==='"'||s==="'"?c=s:s===">"?(l(),i=1):i&&(s==="="?(i=5,o=r,r=""):s==="/"&&(i<5||n[p][u+1]===">")?(l(),i===3&&(d=d[0]),i=d,(d=d[0]).push(2,0,i),i=0):s===" "||s==="	"||s===`
`||s==="\r"?(l(),i=2):r+=s),i===3&&r==="!--"&&(i=4,d=d[0])}return l(),d}(e)),t),arguments,[])).length>1?t:t[0]}var a=hn.bind(Ze);var Ee,O,Ct,mn,Ye=0,xn=[],A=w,vn=A.__b,_n=A.__r,$n=A.diffed,gn=A.__c,bn=A.unmount,yn=A.__;function Et(e,t){A.__h&&A.__h(O,e,Ye||t),Ye=0;var n=O.__H||(O.__H={__:[],__h:[]});return e>=n.__.length&&n.__.push({}),n.__[e]}function $(e){return Ye=1,xs(Sn,e)}function xs(e,t,n){var s=Et(Ee++,2);if(s.t=e,!s.__c&&(s.__=[n?n(t):Sn(void 0,t),function(c){var d=s.__N?s.__N[0]:s.__[0],l=s.t(d,c);d!==l&&(s.__N=[l,s.__[1]],s.__c.setState({}))}],s.__c=O,!O.__f)){var o=function(c,d,l){if(!s.__c.__H)return!0;var p=s.__c.__H.__.filter(function(h){return!!h.__c});if(p.every(function(h){return!h.__N}))return!i||i.call(this,c,d,l);var u=s.__c.props!==c;return p.forEach(function(h){if(h.__N){var f=h.__[0];h.__=h.__N,h.__N=void 0,f!==h.__[0]&&(u=!0)}}),i&&i.call(this,c,d,l)||u};O.__f=!0;var i=O.shouldComponentUpdate,r=O.componentWillUpdate;O.componentWillUpdate=function(c,d,l){if(this.__e){var p=i;i=void 0,o(c,d,l),i=p}r&&r.call(this,c,d,l)},O.shouldComponentUpdate=o}return s.__N||s.__}function M(e,t){var n=Et(Ee++,3);!A.__s&&kn(n.__H,t)&&(n.__=e,n.u=t,O.__H.__h.push(n))}function ce(e){return Ye=5,et(function(){return{current:e}},[])}function et(e,t){var n=Et(Ee++,7);return kn(n.__H,t)&&(n.__=e(),n.__H=t,n.__h=e),n.__}function ks(){for(var e;e=xn.shift();)if(e.__P&&e.__H)try{e.__H.__h.forEach(Qe),e.__H.__h.forEach(Tt),e.__H.__h=[]}catch(t){e.__H.__h=[],A.__e(t,e.__v)}}A.__b=function(e){O=null,vn&&vn(e)},A.__=function(e,t){e&&t.__k&&t.__k.__m&&(e.__m=t.__k.__m),yn&&yn(e,t)},A.__r=function(e){_n&&_n(e),Ee=0;var t=(O=e.__c).__H;t&&(Ct===O?(t.__h=[],O.__h=[],t.__.forEach(function(n){n.__N&&(n.__=n.__N),n.u=n.__N=void 0})):(t.__h.forEach(Qe),t.__h.forEach(Tt),t.__h=[],Ee=0)),Ct=O},A.diffed=function(e){$n&&$n(e);var t=e.__c;t&&t.__H&&(t.__H.__h.length&&(xn.push(t)!==1&&mn===A.requestAnimationFrame||((mn=A.requestAnimationFrame)||Ss)(ks)),t.__H.__.forEach(function(n){n.u&&(n.__H=n.u),n.u=void 0})),Ct=O=null},A.__c=function(e,t){t.some(function(n){try{n.__h.forEach(Qe),n.__h=n.__h.filter(function(s){return!s.__||Tt(s)})}catch(s){t.some(function(o){o.__h&&(o.__h=[])}),t=[],A.__e(s,n.__v)}}),gn&&gn(e,t)},A.unmount=function(e){bn&&bn(e);var t,n=e.__c;n&&n.__H&&(n.__H.__.forEach(function(s){try{Qe(s)}catch(o){t=o}}),n.__H=void 0,t&&A.__e(t,n.__v))};var wn=typeof requestAnimationFrame=="function";function Ss(e){var t,n=function(){clearTimeout(s),wn&&cancelAnimationFrame(t),setTimeout(e)},s=setTimeout(n,35);wn&&(t=requestAnimationFrame(n))}function Qe(e){var t=O,n=e.__c;typeof n=="function"&&(e.__c=void 0,n()),O=t}function Tt(e){var t=O;e.__c=e.__(),O=t}function kn(e,t){return!e||e.length!==t.length||t.some(function(n,s){return n!==e[s]})}function Sn(e,t){return typeof t=="function"?t(e):t}var Ms=Symbol.for("preact-signals");function ot(){if(ee>1)ee--;else{var e,t=!1;for(function(){var o=nt;for(nt=void 0;o!==void 0;){var i=o.S;if(i.v===o.v)for(var r=i.t;r!==void 0;r=r.x)r.i===o.i&&(r.i=i.i);o=o.o}}();Oe!==void 0;){var n=Oe;for(Oe=void 0,tt++;n!==void 0;){var s=n.u;if(n.u=void 0,n.f&=-3,!(8&n.f)&&Cn(n))try{n.c()}catch(o){t||(e=o,t=!0)}n=s}}if(tt=0,ee--,t)throw e}}function ue(e){if(ee>0)return e();Nt=++Cs,ee++;try{return e()}finally{ot()}}var Ne,C=void 0;function Ae(e){var t=C,n=Ne;C=void 0,Ne=void 0;try{return e()}finally{C=t,Ne=n}}var Oe=void 0,ee=0,tt=0,Cs=0,Nt=0,nt=void 0,st=0;function Mn(e){if(C!==void 0){var t=e.n;if(t===void 0||t.t!==C)return t={i:0,S:e,p:C.s,n:void 0,t:C,e:void 0,x:void 0,r:t},C.s!==void 0&&(C.s.n=t),C.s=t,e.n=t,32&C.f&&e.S(t),t;if(t.i===-1)return t.i=0,t.n!==void 0&&(t.n.p=t.p,t.p!==void 0&&(t.p.n=t.n),t.p=C.s,t.n=void 0,C.s.n=t,C.s=t),t}}function R(e,t){this.v=e,this.i=0,this.n=void 0,this.t=void 0,this.l=0,this.W=t?.watched,this.Z=t?.unwatched,this.name=t?.name}R.prototype.brand=Ms;R.prototype.h=function(){return!0};R.prototype.S=function(e){var t=this,n=this.t;n!==e&&e.e===void 0&&(e.x=n,this.t=e,n!==void 0?n.e=e:Ae(function(){var s;(s=t.W)==null||s.call(t)}))};R.prototype.U=function(e){var t=this;if(this.t!==void 0){var n=e.e,s=e.x;n!==void 0&&(n.x=s,e.e=void 0),s!==void 0&&(s.e=n,e.x=void 0),e===this.t&&(this.t=s,s===void 0&&Ae(function(){var o;(o=t.Z)==null||o.call(t)}))}};R.prototype.subscribe=function(e){var t=this;return ye(function(){var n=t.value;Ae(function(){return e(n)})},{name:"sub"})};R.prototype.valueOf=function(){return this.value};R.prototype.toString=function(){return this.value+""};R.prototype.toJSON=function(){return this.value};R.prototype.peek=function(){var e=this;return Ae(function(){return e.value})};Object.defineProperty(R.prototype,"value",{get:function(){var e=Mn(this);return e!==void 0&&(e.i=this.i),this.v},set:function(e){if(e!==this.v){if(tt>100)throw new Error("Cycle detected");(function(n){ee!==0&&tt===0&&n.l!==Nt&&(n.l=Nt,nt={S:n,v:n.v,i:n.i,o:nt})})(this),this.v=e,this.i++,st++,ee++;try{for(var t=this.t;t!==void 0;t=t.x)t.t.N()}finally{ot()}}}});function k(e,t){return new R(e,t)}function Cn(e){for(var t=e.s;t!==void 0;t=t.n)if(t.S.i!==t.i||!t.S.h()||t.S.i!==t.i)return!0;return!1}function Tn(e){for(var t=e.s;t!==void 0;t=t.n){var n=t.S.n;if(n!==void 0&&(t.r=n),t.S.n=t,t.i=-1,t.n===void 0){e.s=t;break}}}function En(e){for(var t=e.s,n=void 0;t!==void 0;){var s=t.p;t.i===-1?(t.S.U(t),s!==void 0&&(s.n=t.n),t.n!==void 0&&(t.n.p=s)):n=t,t.S.n=t.r,t.r!==void 0&&(t.r=void 0),t=s}e.s=n}function de(e,t){R.call(this,void 0,t),this.x=e,this.s=void 0,this.g=st-1,this.f=4}de.prototype=new R;de.prototype.h=function(){if(this.f&=-3,1&this.f)return!1;if((36&this.f)==32||(this.f&=-5,this.g===st))return!0;if(this.g=st,this.f|=1,this.i>0&&!Cn(this))return this.f&=-2,!0;var e=C;try{Tn(this),C=this;var t=this.x();(16&this.f||this.v!==t||this.i===0)&&(this.v=t,this.f&=-17,this.i++)}catch(n){this.v=n,this.f|=16,this.i++}return C=e,En(this),this.f&=-2,!0};de.prototype.S=function(e){if(this.t===void 0){this.f|=36;for(var t=this.s;t!==void 0;t=t.n)t.S.S(t)}R.prototype.S.call(this,e)};de.prototype.U=function(e){if(this.t!==void 0&&(R.prototype.U.call(this,e),this.t===void 0)){this.f&=-33;for(var t=this.s;t!==void 0;t=t.n)t.S.U(t)}};de.prototype.N=function(){if(!(2&this.f)){this.f|=6;for(var e=this.t;e!==void 0;e=e.x)e.t.N()}};Object.defineProperty(de.prototype,"value",{get:function(){if(1&this.f)throw new Error("Cycle detected");var e=Mn(this);if(this.h(),e!==void 0&&(e.i=this.i),16&this.f)throw this.v;return this.v}});function B(e,t){return new de(e,t)}function Nn(e){var t=e.j;if(e.j=void 0,typeof t=="function"){ee++;var n=C;C=void 0;try{t()}catch(s){throw e.f&=-2,e.f|=8,Ot(e),s}finally{C=n,ot()}}}function Ot(e){for(var t=e.s;t!==void 0;t=t.n)t.S.U(t);e.x=void 0,e.s=void 0,Nn(e)}function Ts(e){if(C!==this)throw new Error("Out-of-order effect");En(this),C=e,this.f&=-2;try{8&this.f&&Ot(this)}finally{ot()}}function be(e,t){this.x=e,this.j=void 0,this.s=void 0,this.u=void 0,this.f=32,this.name=t?.name,Ne&&Ne.push(this)}be.prototype.c=function(){var e=this.S();try{if(8&this.f||this.x===void 0)return;var t=this.x();typeof t=="function"&&(this.j=t)}finally{e()}};be.prototype.S=function(){if(1&this.f)throw new Error("Cycle detected");this.f|=1,this.f&=-9,Nn(this),Tn(this),ee++;var e=C;return C=this,Ts.bind(this,e)};be.prototype.N=function(){2&this.f||(this.f|=2,this.u=Oe,Oe=this)};be.prototype.d=function(){this.f|=8,1&this.f||Ot(this)};be.prototype.dispose=function(){this.d()};function ye(e,t){var n=new be(e,t);try{n.c()}catch(o){throw n.d(),o}var s=n.d.bind(n);return s[Symbol.dispose]=s,s}var Rt,At;function we(e,t){w[e]=t.bind(null,w[e]||function(){})}function it(e){At&&At(),At=e&&e.S()}function On(e){var t=this,n=e.data,s=Ns(n);s.value=n;var o=et(function(){for(var i=t,r=t.__v;r=r.__;)if(r.__c){r.__c.__$f|=4;break}var c=B(function(){var l=s.value.value;return l===0?0:l===!0?"":l||""}),d=B(function(){var l;return Ke(c.value)||((l=t.base)==null?void 0:l.nodeType)!==3});return t.__$u.c=function(){var l;!Ke(o.peek())&&((l=t.base)==null?void 0:l.nodeType)===3?t.base.data=o.peek():(t.__$f|=1,t.setState({}))},ye(function(){Re||(Re=this.N),this.N=Rn,d.value&&i.base&&(i.base.data=c.value)}),c},[]);return o.value}On.displayName="_st";Object.defineProperties(R.prototype,{constructor:{configurable:!0,value:void 0},type:{configurable:!0,value:On},props:{configurable:!0,get:function(){return{data:this}}},__b:{configurable:!0,value:1}});we("__b",function(e,t){if(typeof t.type=="string"){var n,s=t.props;for(var o in s)if(o!=="children"){var i=s[o];i instanceof R&&(n||(t.__np=n={}),n[o]=i,s[o]=i.peek())}}e(t)});we("__r",function(e,t){it();var n,s=t.__c;s&&(s.__$f&=-2,(n=s.__$u)===void 0&&(s.__$u=n=function(o){var i;return ye(function(){i=this}),i.c=function(){s.__$f|=1,s.setState({})},i}())),Rt=s,it(n),e(t)});we("__e",function(e,t,n,s){it(),Rt=void 0,e(t,n,s)});we("diffed",function(e,t){it(),Rt=void 0;var n;if(typeof t.type=="string"&&(n=t.__e)){var s=t.__np,o=t.props;if(s){var i=n.U;if(i)for(var r in i){var c=i[r];c!==void 0&&!(r in s)&&(c.d(),i[r]=void 0)}else n.U=i={};for(var d in s){var l=i[d],p=s[d];l===void 0?(l=Es(n,d,p,o),i[d]=l):l.o(p,o)}}}e(t)});function Es(e,t,n,s){var o=t in e&&e.ownerSVGElement===void 0,i=k(n);return{o:function(r,c){i.value=r,s=c},d:ye(function(){Re||(Re=this.N),this.N=Rn;var r=i.value.value;s[t]!==r&&(s[t]=r,o?e[t]=r:r?e.setAttribute(t,r):e.removeAttribute(t))})}}we("unmount",function(e,t){if(typeof t.type=="string"){var n=t.__e;if(n){var s=n.U;if(s){n.U=void 0;for(var o in s){var i=s[o];i&&i.d()}}}}else{var r=t.__c;if(r){var c=r.__$u;c&&(r.__$u=void 0,c.d())}}e(t)});we("__h",function(e,t,n,s){(s<3||s===9)&&(t.__$f|=2),e(t,n,s)});le.prototype.shouldComponentUpdate=function(e,t){var n=this.__$u;if(!(n&&n.s!==void 0||4&this.__$f)||3&this.__$f)return!0;for(var s in t)return!0;for(var o in e)if(o!=="__source"&&e[o]!==this.props[o])return!0;for(var i in this.props)if(!(i in e))return!0;return!1};function Ns(e){return et(function(){return k(e)},[])}var Re;var An=[];var Os=function(e){queueMicrotask(function(){queueMicrotask(e)})};function As(){ue(function(){for(var e;e=An.shift();)Re.call(e)})}function Rn(){An.push(this)===1&&(w.requestAnimationFrame||Os)(As)}var Ie=k(innerWidth);addEventListener("resize",()=>Ie.value=innerWidth);var E=({title:e,note:t,id:n,children:s,className:o=""})=>a`
  <section class="card ${o}" aria-labelledby=${n}>
    <header class="card-head"><h2 id=${n}>${e}</h2>${t&&a`<p class="note">${t}</p>`}</header>
    ${s}
  </section>`,P=({problem:e})=>e&&a`
    <div class="problem" role="alert">
      <p><strong>${e.message}</strong>${e.code&&a` <span class="code">${e.code}</span>`}</p>
      ${e.hint&&a`<p>${e.hint}</p>`}
      ${e.diagnostics?.length>0&&a`<ul class="findings">
        ${e.diagnostics.slice(0,50).map(t=>a`<li>
          <span class="code">${t.code}</span> <span class="place">${Rs(t.span)}</span> ${t.message}
          ${t.hint&&a`<span class="hint"> ${t.hint}</span>`}
          ${t.excerpt&&a`<pre tabindex="0">${t.excerpt}</pre>`}
        </li>`)}
      </ul>`}
    </div>`,Rs=e=>[e.file,e.line,e.column].filter(Boolean).join(":");function z(){let e=ce(null),[t,n]=$(0);return M(()=>{let s=new ResizeObserver(([o])=>n(Math.floor(o.contentRect.width)));return s.observe(e.current),()=>s.disconnect()},[]),[e,t]}var It="aos-token",rt=class extends Error{constructor(t){super(t.detail||t.title||"the gateway cannot be reached"),Object.assign(this,{code:"",hint:"",diagnostics:[]},t)}},q=()=>!!localStorage.getItem(It);async function In(e){localStorage.setItem(It,e),await fetch("/v1/session",{method:"POST",headers:Pn()})}var Pn=()=>{let e=localStorage.getItem(It);return e?{authorization:`Bearer ${e}`}:{}};async function at(e,t={}){let n;try{n=await fetch(e,{...t,headers:{...Pn(),...t.headers}})}catch{throw new rt({detail:"The gateway cannot be reached.",hint:"Is `aos serve` still running?"})}if(n.ok)return n;let s;try{s=await n.json()}catch{s={detail:`The gateway answered ${n.status}.`}}throw new rt(s)}var I=async e=>(await at(e)).json(),jn=async e=>(await at(e)).text(),oe=async(e,t={})=>(await at(e,{method:"POST",body:JSON.stringify(t),headers:{"content-type":"application/json"}})).json(),lt=async(e,t)=>(await at(`${e}?name=${encodeURIComponent(t.name)}`,{method:"POST",body:t})).json();var jt=["overview","why","steps","model","documents","system"],Pt=()=>{let[e,t=""]=location.hash.replace(/^#/,"").split("?"),[n="",s="",o="overview"]=e.split("/").filter(Boolean).map(decodeURIComponent),i=new URLSearchParams(t),r=Number(i.get("step"))||null;return{kind:n,name:s,view:jt.includes(o)?o:"overview",step:r,token:i.get("token")}},x=k({kind:"",name:"",view:"overview",step:null}),j=(e,t="overview",n=null)=>`#/missions/${encodeURIComponent(e)}${t==="overview"?"":`/${t}`}${n?`?step=${n}`:""}`;function ie(e,{replace:t=!1}={}){t?history.replaceState(null,"",e):history.pushState(null,"",e),x.value=Pt()}async function Dn(){let e=async()=>{let t=Pt();if(t.token){let n=location.hash.replace(/([?&])token=[^&]*&?/,"$1").replace(/[?&]$/,"");history.replaceState(null,"",n||"#/"),await In(t.token).catch(()=>{})}x.value=Pt()};addEventListener("hashchange",e),addEventListener("popstate",e),await e()}var xe=k(null),X=k(null),D=k(null),T=k(null),S=k([]),V=k([]),pe=new Map,Ft=k(0),fe=k(new Map),je=k(null),Pe=k([]),Z=k("connecting"),J=k([]),he=k(null),Un=k(null),De=B(()=>S.value.at(-1)??null),me=B(()=>x.value.step===null),b=B(()=>{let e=S.value;if(!e.length)return null;let t=x.value.step;return t===null?e.at(-1):e[Math.min(Math.max(t-e[0].step,0),e.length-1)]}),te=B(()=>b.value?b.value.step-S.value[0].step:-1),ve=B(()=>(Ft.value,b.value?pe.get(b.value.step)??null:null)),ut=B(()=>{let e=new Map;for(let t of S.value.slice(0,te.value+1)){t.adopted&&e.clear();for(let n of t.drift??[]){let s=`${n.skill} ${n.response}`;e.set(s,{...n,since:e.get(s)?.since??t.step})}}return[...e.values()]}),K=null,ct=[],Dt=!1;function F(e){let{name:t,view:n}=x.value,s=De.value?.step;ie(j(t,n,e===null||e>=s?null:Math.max(e,S.value[0]?.step??1)),{replace:!0})}async function Fe(){try{xe.value=(await I("/v1/runs?limit=100")).runs,X.value=null}catch(e){X.value=e}}function dt(e="",t=0){K?.close();let n=e?`?mission=${encodeURIComponent(e)}&since=${t}`:"";K=new EventSource(`/v1/events${n}`);let s=K;K.onopen=()=>Z.value=T.value?.phase==="ended"?"over":"live",K.onerror=()=>{s===K&&(Z.value="lost",s.readyState===EventSource.CLOSED&&setTimeout(()=>s===K&&Is(e),1500))};for(let o of["decision","state","service","progress","bundle","runs"])K.addEventListener(o,i=>{ct.push([o,JSON.parse(i.data)]),Dt||(Dt=!0,document.hidden?setTimeout(Fn,200):requestAnimationFrame(Fn))})}var Is=e=>e?pt(e,{again:!0}):dt();async function pt(e,{again:t=!1}={}){let n=performance.now(),s=`/v1/missions/${encodeURIComponent(e)}`;t||Wn(),Z.value=t?"lost":"connecting";try{let[o,i]=await Promise.all([I(s),I(`${s}/trace`)]);if(x.value.name!==e)return;ue(()=>{pe.clear(),D.value=o,T.value=o.state??null,S.value=i.steps.map(qn),V.value=Bn(S.value),X.value=null,Un.value=performance.now()-n}),dt(e,i.next),Ln(e)}catch(o){X.value=o,t&&setTimeout(()=>x.value.name===e&&pt(e,{again:t}),1500)}}function Wn(){K?.close(),K=null,ct=[],pe.clear(),ue(()=>{D.value=T.value=je.value=he.value=Un.value=null,S.value=V.value=Pe.value=J.value=[],fe.value=new Map})}var Hn=()=>Wn();async function Ln(e){try{J.value=(await I(`/v1/missions/${encodeURIComponent(e)}/world`)).steps}catch{J.value=[]}}async function zn(e){if(pe.has(e)||!D.value)return;let{name:t}=x.value;try{let n=await I(`/v1/missions/${encodeURIComponent(t)}/decisions/${e}`);if(x.value.name!==t)return;pe.set(e,n),Ft.value++}catch{}}var qn=e=>({status:"",surprise:0,...e});function Fn(){Dt=!1;let e=ct;ct=[],ue(()=>{let t=[];for(let[n,s]of e)n==="decision"?t.push(s):n==="state"?Ps(s):n==="service"?fe.value=new Map(fe.value).set(s.service,s.is_there):n==="progress"?je.value=s:n==="bundle"?Pe.value=[s,...Pe.value].slice(0,20):n==="runs"&&(xe.value=s);t.length&&js(t)})}function Ps(e){if(x.value.name&&e.mission!==x.value.name){e.phase!=="waiting"&&(he.value=e.mission);return}T.value=e,e.phase==="ended"?(Z.value="over",I(`/v1/missions/${encodeURIComponent(e.mission)}`).then(t=>x.value.name===e.mission&&(D.value=t),()=>{}),Ln(e.mission)):Z.value==="over"&&(Z.value="live")}function js(e){let t=S.value.slice(),n=t.length;for(let{record:s,row:o}of e){let i=qn(o),r=t.length?i.step-t[0].step:0;if(r<0)continue;let c=t[r];if(c&&c.sequence>=i.sequence)continue;t[r]=c&&s.outcome?{...c,...i,belief:{...c.belief,...i.belief},endings:c.endings,predicted:c.predicted}:i,n=Math.min(n,r);let d={...pe.get(i.step)};d[s.outcome?"observed":"decided"]=s,(d.decided||!s.outcome)&&pe.set(i.step,d),s.outcome&&(je.value=null,!J.value.includes(i.step)&&J.value.length&&(J.value=[...J.value,i.step]))}S.value=t,V.value=Bn(t,V.value,n),Ft.value++}function Bn(e,t=[],n=0){let s=t.slice(0,n+(n?1:0));for(let o=s.length?s.length-1:0;o<e.length;o++){let i={...s[o]??{},...e[o].belief??{}};s[o]=i,s[o+1]={...i,...e[o].after??{}}}return s}var W=e=>typeof e=="number"&&Number.isFinite(e);function H(e,t=2){if(!W(e))return"–";let n=Math.abs(e)>=1e3?Math.round(Math.abs(e)).toLocaleString("en"):Math.abs(e).toFixed(t);return`${e<0?"−":"+"}${n}`}var L=(e,t=2)=>W(e)?e.toFixed(t):"–";function N(e){return W(e)?e>.9995&&e<1?">0.999":e<5e-4&&e>0?"<0.001":e.toFixed(3):"–"}function re(e){return W(e)?e>.995&&e<1?">99 %":e<.005&&e>0?"<1 %":`${Math.round(e*100)} %`:"–"}function Ue(e){return W(e)?e<.001?"<1 ms":e<1?`${Math.round(e*1e3)} ms`:e<60?`${e.toFixed(1)} s`:`${Math.floor(e/60)} min ${Math.round(e%60)} s`:""}function ft(e){let t=new Date(e);if(Number.isNaN(t.getTime()))return"";let n=t.toDateString()===new Date().toDateString(),s=t.toLocaleTimeString([],{hour:"2-digit",minute:"2-digit"});return n?`today, ${s}`:`${t.toLocaleDateString([],{day:"numeric",month:"short"})}, ${s}`}var Ds={goal:"Goal reached",over:"Over, no goal",failure:"Failed",nothing_worthwhile:"Nothing worth doing",too_risky:"Too risky",step_limit:"Step limit",skills_failed:"Skills kept failing",cancelled:"Cancelled",fault:"Fault",not_started:"Not started",stopped:"Stopped",killed:"Killed",running:"Running",unreachable:"Unreachable"},ht=e=>Ds[e]??e,Fs={waiting:"Waiting",building:"Building the model",planning:"Deciding",acting:"Acting",holding:"Holding"},Vn=e=>Fs[e]??e,Q=e=>e.replace(/([(,] ?)\w+=/g,"$1");function Kn(){let e=xe.value,t=(e??[]).filter(s=>s.is_running),n=(e??[]).filter(s=>!s.is_running);return a`<main class="home" id="main">
    <div class="home-list">
      <h1>Missions</h1>
      <${P} problem=${X.value} />
      ${e===null&&!X.value&&a`<p class="empty">Looking for runs…</p>`}
      ${t.length>0&&a`<h2 class="group">Running</h2><ul class="runs">${t.map(s=>a`<${Gn} key=${s.run} run=${s} />`)}</ul>`}
      ${n.length>0&&a`<h2 class="group">Past</h2><ul class="runs">${n.map(s=>a`<${Gn} key=${s.run} run=${s} />`)}</ul>`}
      ${e?.length===0&&a`<div class="welcome">
        <p>No mission has run in this folder yet.</p>
        <p>Start one here, or with <code>aos-up</code> in a terminal: it appears by itself.</p>
      </div>`}
    </div>
    <aside class="home-aside"><${Us} /></aside>
  </main>`}function Gn({run:e}){let t=e.missions??[],n=t.at(-1)??e.run,s=e.deploy_file?.split("/").at(-1)?.replace(/\.ya?ml$/,"");return a`<li class=${e.is_running?"run is-running":"run"}>
    <a href=${j(n)}>
      <span class="run-name"><b>${e.robot}</b>${s&&s!==e.robot?a`<span class="muted">${s}</span>`:""}</span>
      <span class=${`ending is-${e.ending}`}>${e.is_running&&a`<i class="pulse"></i>`}${ht(e.ending)}</span>
      <span class="run-when muted">${ft(e.started)||e.endpoint}</span>
    </a>
    ${t.length>1&&a`<details><summary>${t.length} missions</summary><ul class="of-run">${t.slice().reverse().map((o,i)=>a`<li><a href=${j(o)}>Mission ${t.length-i}</a></li>`)}</ul></details>`}
  </li>`}function Us(){let[e,t]=$([]),[n,s]=$(""),[o,i]=$({model:!0,stay:!1,seed:""}),[r,c]=$(null),[d,l]=$(""),p=()=>I("/v1/projects").then(v=>{t(v.projects),s(m=>m||v.projects[0]?.deploy_file||"")},c);M(()=>void p(),[]);async function u(v){v.preventDefault(),l("Starting…"),c(null);try{let m={deploy_file:n,model:o.model,stay:o.stay};o.seed!==""&&(m.seed=Number(o.seed));let _=await oe("/v1/runs",m);await Fe(),ie(j(_.mission))}catch(m){c(m)}l("")}async function h(v){let m=v.target.files[0];if(m){l(`Checking ${m.name}…`),c(null);try{let _=await lt("/v1/projects",m);await p(),s(_.deploy_file)}catch(_){c(_)}l(""),v.target.value=""}}let f=(v,m)=>i({...o,[v]:m});return q()?a`<section class="card start" aria-labelledby="start">
    <h2 id="start">New mission</h2>
    <form onSubmit=${u}>
      <label class="field">Project
        <select value=${n} onChange=${v=>s(v.target.value)}>
          ${e.map(v=>a`<option value=${v.deploy_file}>${v.project}${v.is_uploaded?" (uploaded)":""}</option>`)}
          ${!e.length&&a`<option value="">No deploy file in this folder</option>`}
        </select></label>
      <label class="field">Seed <input inputmode="numeric" pattern="[0-9]*" placeholder="that of the file" value=${o.seed} onInput=${v=>f("seed",v.target.value)} /></label>
      <label class="check"><input type="checkbox" checked=${o.model} onChange=${v=>f("model",v.target.checked)} /> Skills are played by their documents; no robot moves</label>
      <label class="check"><input type="checkbox" checked=${o.stay} onChange=${v=>f("stay",v.target.checked)} /> Stay for further missions</label>
      <button class="primary" disabled=${!n||!!d}>Start mission</button>
      <p role="status" class="note">${d}</p>
    </form>
    <hr />
    <label class="button">Upload a bundle…<input type="file" class="visually-hidden" onChange=${h} accept=".zip,.tar,.gz,.tgz,.xz,.bz2" /></label>
    <p class="note">An archive of documents. It is checked first, and played by its own documents.</p>
    <${P} problem=${r} />
  </section>`:a`<section class="card start" aria-labelledby="start"><h2 id="start">New mission</h2>
      <p class="note">Open the address that <code>aos serve</code> prints, to start missions here. Without it this page only reads.</p></section>`}var Ut=k(null),$e=k(""),Jn=()=>q()&&D.value?.is_running&&T.value&&T.value.phase!=="ended",Ws=()=>!!T.value?.held_by||T.value?.phase==="holding";async function _e(e,t={}){let{name:n}=x.value;$e.value=e,Ut.value=null;try{let s=await oe(`/v1/missions/${encodeURIComponent(n)}/steering`,{verb:e,...t});x.value.name===n&&(T.value=s)}catch(s){Ut.value=s}$e.value=""}function Zn(){if(he.value)return a`<a class="button primary" href=${j(he.value)}>To the next mission</a>`;if(!D.value?.is_running||!T.value||T.value.phase==="ended")return null;if(!q())return a`<p class="controls note">Read only</p>`;let e=!!$e.value;return a`<div class="controls" role="group" aria-label="Steering">
    ${Ws()?a`<button class="primary" disabled=${e} onClick=${()=>_e("resume")}>Go on</button>`:a`<button disabled=${e} onClick=${()=>_e("hold")}>Hold</button>`}
    <button disabled=${e} onClick=${()=>_e("step")} title="One more decision, then hold">Step</button>
    <button class="stop" disabled=${$e.value==="stop"} onClick=${()=>_e("stop")}>${$e.value==="stop"?"Stopping…":"Stop"}</button>
    <${P} problem=${Ut.value} />
  </div>`}var Xn=({action:e})=>Jn()&&a`<span class="of-action">
    <button class="quiet" disabled=${!!$e.value} onClick=${()=>_e("act",{actions:[e]})} aria-label=${`Do ${e}`}>Do</button>
    <button class="quiet" disabled=${!!$e.value} onClick=${()=>_e("leave_out",{name:e})} aria-label=${`Leave out ${e}`}>Leave out</button>
  </span>`;function Qn(){let e=Object.entries(T.value?.left_out??{}),t=T.value?.asked??[];return!e.length&&!t.length?null:a`<div class="left-out">
    ${t.length>0&&a`<p class="aside">Still to come: ${t.map(n=>a`<span class="chip">${n}</span> `)}</p>`}
    ${e.map(([n,s])=>a`<p class="aside"><span class="chip">${n}</span> is left out by ${s} ${Jn()&&a`<button class="link" onClick=${()=>_e("take_back",{name:n})}>Take it back</button>`}</p>`)}
  </div>`}function Yn(){let[e,t]=$(!1),[n,s]=$({belief:"initial",given:"",idle:"0"}),[o,i]=$({}),[r,c]=$(null),[d,l]=$(!1),p=D.value?.run,u=T.value?.phase==="ended";if(M(()=>{!p||!u||!q()||I(`/v1/runs/${encodeURIComponent(p)}`).then(m=>t(m.is_running&&m.stays&&m.missions.at(-1)===T.value?.mission),()=>t(!1))},[p,u]),!e||he.value||!q())return null;let h=Object.entries(D.value?.parameters??{}),f=m=>_=>s({...n,[m]:_.target.value});async function v(m){m.preventDefault(),l(!0),c(null);let _={belief:n.belief,idle:Number(n.idle||0),given:n.given.split(`
`).map(g=>g.trim()).filter(Boolean),values:o};try{ie(j((await oe(`/v1/runs/${encodeURIComponent(p)}/missions`,_)).mission))}catch(g){c(g),l(!1)}}return a`<details class="card next">
    <summary>Next mission</summary>
    <form onSubmit=${v}>
      <label class="field">Belief at the start
        <select value=${n.belief} onChange=${f("belief")}><option value="initial">the initial one</option><option value="keep">the last one of this mission</option></select></label>
      <label class="field">Idle steps before it <input type="number" min="0" max="10000" value=${n.idle} onInput=${f("idle")} /></label>
      ${h.map(([m,_])=>a`<label class="field" key=${m}>${m}
        <input value=${o[m]??_} onInput=${g=>i({...o,[m]:g.target.value})} /></label>`)}
      <label class="field wide">What is known, one expression a line <textarea rows="2" placeholder="state.robot_at == Kitchen" value=${n.given} onInput=${f("given")}></textarea></label>
      <button class="primary" disabled=${d}>${d?"Beginning…":"Begin it"}</button>
    </form>
    <${P} problem=${r} />
  </details>`}var es=["#4477aa","#ccbb44","#66ccee","#aa3377","#228833","#ee6677","#8a8f98"],Hs=new Set(["#ccbb44","#66ccee","#ee6677"]),Ls=new Set(["false","no","none","0"]),Wt=e=>es[e%es.length],mt=e=>e.startsWith("var")?"var(--ink)":Hs.has(e)?"#14171a":"#ffffff";function ts(e){let t=new Map,n=0;for(let s of e){let o=Ls.has(s.toLowerCase())||s==="…";t.set(s,o?"var(--quiet)":Wt(n++))}return t}var Ht=26,zs=2,U=(e,t,n=0)=>n+e/Math.max(1,S.value.length)*(t-n),We=e=>e.impossible||e.surprise>=zs,vt=e=>e.chosen_by==="operator"||e.chosen_by==="script",He=e=>!!e.status&&e.status!=="observed",qs=()=>{let e=new Map;for(let t of S.value)e.has(t.skill)||e.set(t.skill,Wt(e.size));return e};function Lt({room:e,height:t,head:n=0}){if(te.value<0)return null;let s=U(te.value,e,n),o=U(te.value+1,e,n);return a`<rect class="cursor" x=${s+.75} y="0.75" width=${Math.max(1.5,o-s-1.5)} height=${t-1.5} rx="2" />`}function ns(){let[e,t]=z(),n=S.value,s=qs(),o=b.value;if(!n.length)return a`<div class="timeline" ref=${e}></div>`;let i=n[0].step,r=De.value.step;return a`<div class="timeline">
    <div class="timeline-track" ref=${e}>
      <svg width=${t} height=${Ht+12} aria-hidden="true">
        <g transform="translate(0 12)">
          ${t>0&&Bs(n,t,s)}
          <${Lt} room=${t} height=${Ht} />
        </g>
        ${t>0&&Vs(n,t)}
      </svg>
      <input type="range" min=${i} max=${r} step="1" value=${o.step}
        aria-label="Step" aria-valuetext=${`step ${o.step}, ${o.action}`}
        onInput=${c=>F(Number(c.target.value))} />
    </div>
    <div class="timeline-foot">
      <ul class="legend" aria-label="Skills">
        ${[...s].map(([c,d])=>a`<li><i style=${{background:d}}></i>${c}</li>`)}
        ${n.some(We)&&a`<li><svg width="10" height="9" aria-hidden="true"><path class="surprise" d="M5 0 l5 9 h-10z" /></svg>surprise</li>`}
        ${n.some(He)&&a`<li><svg width="9" height="9" aria-hidden="true"><path class="failed" d="M1 1 l7 7 M8 1 l-7 7" /></svg>not observed</li>`}
        ${n.some(vt)&&a`<li><svg width="9" height="9" aria-hidden="true"><rect class="asked" x="1" y="1" width="7" height="7" rx="1" /></svg>asked for by a person</li>`}
        ${n.some(c=>c.adopted)&&a`<li><svg width="9" height="9" aria-hidden="true"><path class="adopted" d="M4.5 0 l4.5 4.5 l-4.5 4.5 l-4.5 -4.5z" /></svg>new model</li>`}
      </ul>
      <div class="stepper">
        <button class="quiet" onClick=${()=>F(o.step-1)} disabled=${o.step<=i} aria-label="Step before">‹</button>
        <span class="stepper-place"><b>${o.step}</b> of ${r}</span>
        <button class="quiet" onClick=${()=>F(o.step+1)} disabled=${o.step>=r} aria-label="Step after">›</button>
        <button class=${`quiet newest ${me.value?"is-on":""}`} aria-pressed=${me.value} onClick=${()=>F(null)}>
          ${T.value?.phase==="ended"?"Last":"Newest"}</button>
      </div>
    </div>
  </div>`}function Bs(e,t,n){let s=U(1,t)-U(0,t),o=s>6?2:0,i=[];for(let r=0;r<e.length;){let c=r+1;if(!o)for(;c<e.length&&e[c].skill===e[r].skill;)c++;let d=n.get(e[r].skill),l=Math.max(1,(c-r)*s-o),p=Q(e[r].action),u=!e[r].status;i.push(a`<rect class=${u?"open":""} x=${U(r,t)} y="0" width=${l} height=${Ht} rx="2" style=${{fill:d,stroke:u?d:"none"}} />`),l>p.length*7.2+12&&i.push(a`<text x=${U(r,t)+6} y="17" style=${{fill:u?"var(--ink)":mt(d)}}>${p}</text>`),r=c}return i}function Vs(e,t){return e.map((n,s)=>{let o=U(s+.5,t);return[We(n)&&a`<path class="surprise" d=${`M${o} 1 l4.5 8 h-9z`}><title>${`step ${n.step}: surprise ${n.impossible?"without end":L(n.surprise)}, expected with ${N(n.expected)}`}</title></path>`,He(n)&&a`<path class="failed" d=${`M${o-3.5} 2 l7 7 M${o+3.5} 2 l-7 7`} />`,vt(n)&&a`<rect class="asked" x=${U(s+.5,t)-(We(n)||He(n)?12:3.5)} y="2" width="7" height="7" rx="1" />`,n.adopted&&a`<path class="adopted" d=${`M${U(s,t)} 1 l4 4 l-4 4 l-4 -4z`} />`]})}function ss(){let e=b.value;return e?a`<div class="decision">
    <p class="sentence"><span class="action">${e.action}</span> ${Gs(e)}</p>
    <p class="came">${Ks(e)}</p>
    ${e.fault&&a`<p class="came fault">${e.fault}</p>`}
    ${e.remark&&a`<p class="came">${e.remark}</p>`}
    ${e.adopted&&a`<p class="came">A new model decided: ${e.adopted}.</p>`}
  </div>`:a`<p class="sentence muted">${T.value?.remark?`${T.value.remark}.`:"No decision has been made yet."}</p>`}function Gs(e){let t=[e.planner,e.simulations?`${e.simulations.toLocaleString("en")} simulations`:"",Ue(e.planning_s)].filter(Boolean).join(", "),n=t&&a`<span class="by">${t}</span>`;if(vt(e))return e.chosen_by==="script"?a`comes from a script of a person.`:a`was asked for by a person.`;if(!W(e.value))return a`was chosen. ${n}`;let s=a`is worth <b>${H(e.value)}</b>${e.error>=.005?` ± ${L(e.error)}`:""}`;if(!e.second)return a`${s}; nothing else can be done. ${n}`;let o=Math.hypot(e.error??0,e.second_error??0),i=a`<span class="other">${e.second}</span>`;return W(e.margin)&&Math.abs(e.margin)<2*o?a`${s}, too close to call against ${i}. ${n}`:e.margin<0?a`${s}, ${L(-e.margin)} less than ${i}. ${n}`:e.margin===0?a`${s}, as much as ${i}. ${n}`:a`${s}, <b>${L(e.margin)}</b> more than ${i}. ${n}`}function Ks(e){let n=Object.entries(e.predicted??{}).sort((i,r)=>r[1]-i[1]).slice(0,3).map(([i,r],c)=>a`${c?", ":""}<span class="response">${i}</span> ${re(r)}`);if(!e.status){let i=je.value;return a`Expected ${n}. ${i&&i.id?.step===e.step?`${i.state}${i.progress?`, ${re(i.progress)}`:""}${i.text?`: ${i.text}`:""}`:a`<span class="waiting">It is running.</span>`}`}if(e.status!=="observed")return a`Expected ${n}. Nothing was observed: <b>${e.status.replace("_"," ")}</b>.`;let s=e.impossible?"The model held that impossible.":`Surprise ${L(e.surprise)}.`,o=e.stopped_by?` It was stopped by ${e.stopped_by}.`:"";return a`Expected ${n}. Saw <b class="response">${e.seen}</b>${W(e.expected)?` (${N(e.expected)})`:""}.${o} ${s}`}var ne=40,zt=8,Js=12,Zs=.2;function is(){let[e,t]=z(),[n,s]=$(!1),o=V.value,i=Bt(o),r=i.filter(p=>p.isDoubtful||p.isMoving),c=n?r:r.slice(0,zt),d=i.filter(p=>!p.isDoubtful&&!p.isMoving),l=te.value;return a`<div class="ribbons" ref=${e}>
    ${t>0&&c.map(p=>a`<${Xs} key=${p.name} row=${p} all=${o} size=${t} now=${l} />`)}
    ${r.length>zt&&a`<button class="link" onClick=${()=>s(!n)}>
      ${n?"Show fewer":`Show ${r.length-zt} more`}</button>`}
    ${d.length>0&&a`<p class="still"><span>Certain throughout</span>
      ${d.slice(0,40).map(p=>a`<span class="chip"><b>${p.name}</b> ${p.values[0]}</span>`)}</p>`}
    ${!i.length&&a`<p class="empty">There is no belief yet.</p>`}
  </div>`}function Xs({row:e,all:t,size:n,now:s}){let o=Ie.value<720,i=Math.max(60,o?n:n-330),r=_t(i),c=ts(e.values),d=t[s+1]?.[e.name]??{},l=Object.entries(d).sort((u,h)=>h[1]-u[1]),p=l.slice(0,2).map(([u,h])=>`${u} ${N(h)}`).join(", ");return a`<div class="ribbon">
    <h3 class="ribbon-name">${e.name}</h3>
    <svg class=${i>4*t.length?"ribbon-plot":"ribbon-plot is-dense"} width=${i} height=${ne} role="img" aria-label=${`${e.name}: ${p}`}
      onClick=${u=>F(Qs(u,i))}>
      ${Ys(e,t,i,c)}
      ${e.moves.length<=Js&&e.moves.map(u=>a`<path class="moved" d=${`M${U(u-1,i,r)} ${ne} l-3.5 5 h7 z`} />`)}
      ${eo(e,t,i,c)}
      <${Lt} room=${i} height=${ne} head=${r} />
    </svg>
    <dl class="ribbon-now">
      ${l.slice(0,2).map(([u,h])=>a`<div><dt><i style=${{background:c.get(u)}}></i>${u}</dt><dd>${N(h)}</dd></div>`)}
    </dl>
  </div>`}var _t=e=>Math.min(24,e/(S.value.length+.5)*.5),Qs=(e,t)=>{let n=S.value.length,s=e.clientX-e.currentTarget.getBoundingClientRect().left,o=_t(t),i=Math.min(n-1,Math.max(0,Math.floor((s-o)/(t-o)*n)));return S.value[i]?.step};function Ys(e,t,n,s){let o=t.length-1;if(o<1)return null;let i=_t(n),r=Math.min(8,n/o*.4),c=new Float64Array(t.length);return e.values.map(d=>{let l="",p="",u=!1;for(let h=0;h<=o;h++){let f=t[h][e.name]?.[d]??0;f>0&&(u=!0);let v=ne-c[h]*ne;c[h]+=f;let m=ne-c[h]*ne,_=h===0?0:U(h-1,n,i)+r/2,g=h===o?n:Math.max(_,U(h,n,i)-r/2);l+=`${l?"L":"M"}${_.toFixed(1)} ${m.toFixed(1)}L${g.toFixed(1)} ${m.toFixed(1)}`,p=`L${g.toFixed(1)} ${v.toFixed(1)}L${_.toFixed(1)} ${v.toFixed(1)}${p}`}return u?a`<path d=${`${l}${p}Z`} style=${{fill:s.get(d)}} />`:null})}function eo(e,t,n,s){let o=[],i=t.length-1,r=_t(n),c=0,d=null,l=p=>{let u=c===0?0:U(c-1,n,r),h=p>i?n:U(p-1,n,r);if(!d||h-u<d.length*7+14)return;let f=0,v=t[c][e.name]??{};for(let _ of e.values){if(_===d)break;f+=v[_]??0}let m=ne-(f+(v[d]??0)/2)*ne;o.push(a`<text x=${u+8} y=${m+4} style=${{fill:mt(s.get(d))}}>${d}</text>`)};for(let p=0;p<=i;p++){let[u,h]=Object.entries(t[p][e.name]??{}).reduce((v,m)=>m[1]>v[1]?m:v,["",0]),f=h>=.5?u:null;f!==d&&(l(p),c=p,d=f)}return l(i+1),o}var qt={all:null,rows:[]};function Bt(e){if(qt.all===e)return qt.rows;let t=new Map;for(let s=0;s<e.length;s++)for(let o in e[s]){let i=e[s][o],r=s?e[s-1][o]:void 0,c=t.get(o);c||t.set(o,c={name:o,weights:new Map,doubt:0,isDoubtful:!1,isMoving:!1,moves:[]});let d=0;for(let l in i){let p=i[l];c.weights.set(l,(c.weights.get(l)??0)+p),p>0&&p<1&&(d-=p*Math.log(p))}if(d>.005&&(c.isDoubtful=!0),c.doubt+=d,r&&r!==i){let l=no(r,i);l>1e-4&&(c.isMoving=!0),l>=Zs&&c.moves.push(s)}}let n=[...t.values()].map(s=>({...s,values:[...s.weights.entries()].sort(to).map(([o])=>o)}));return n.sort((s,o)=>o.doubt-s.doubt||o.moves.length-s.moves.length),qt={all:e,rows:n},n}var os=e=>e==="true"?-1:e==="false"||e==="…"?1:0,to=(e,t)=>os(e[0])-os(t[0]);function no(e,t){let n=0;for(let s in e)n+=Math.abs(e[s]-(t[s]??0));for(let s in t)s in e||(n+=t[s]);return n/2}var rs=8,so=30;function as(){let[e,t]=z(),[n,s]=$(!1),o=ve.value?.decided??ve.value?.observed;if(!b.value||!o||o.step!==b.value.step)return a`<div ref=${e} class="values" aria-busy="true"></div>`;let i=o.actions.filter(l=>W(l.q)).sort((l,p)=>p.q-l.q),r=n?i:i.slice(0,rs),c=i.find(l=>l.action===o.action);c&&!r.includes(c)&&(r=[...r,c]);let d=io(r);return a`<div class="values" ref=${e}>
    <ol>
      ${r.map(l=>a`<${oo} key=${l.action} each=${l} scale=${d} size=${t} found=${o} />`)}
    </ol>
    ${i.length>rs&&a`<button class="link" onClick=${()=>s(!n)}>${n?"Show fewer":`Show all ${i.length}`}</button>`}
    ${!i.length&&a`<p class="empty">${o.planner?`${o.planner} gives no values.`:"There are no values."}</p>`}
    ${Object.entries(o.set_aside??{}).map(([l,p])=>a`<p class="aside"><b>${l}</b> is set aside: ${p}</p>`)}
    ${(o.constraints??[]).map(l=>a`<p class="aside">Never <code>${l.never}</code>: risks ${l.risk.toPrecision(2)} of ${l.left.toPrecision(2)} that are left.</p>`)}
  </div>`}function oo({each:e,scale:t,size:n,found:s}){let o=e.action===s.action,i=Math.max(80,n-(Ie.value<480?84:92)),r=l=>t(l)*(i-16)+8,c=e.stderr??0,d=`${e.action}: ${H(e.q)}${c>=.005?` ± ${c.toFixed(2)}`:""}${o?", chosen":""}`;return a`<li class=${o?"value is-chosen":"value"} aria-label=${d}>
    <span class="value-head"><span class="value-name" title=${e.action}>${o&&a`<span class="chosen-mark" aria-hidden="true">▸</span>`}${Q(e.action)}</span><${Xn} action=${e.action} /></span>
    <span class="value-plot">
      <svg width=${i} height=${so-12} aria-hidden="true">
        <line class="rail" x1="8" x2=${i-8} y1="9" y2="9" />
        ${W(e.at_least)&&W(e.at_most)&&a`<line class="proven" x1=${r(e.at_least)} x2=${r(e.at_most)} y1="9" y2="9" />`}
        ${c>0&&a`<line class="error" x1=${r(e.q-2*c)} x2=${r(e.q+2*c)} y1="9" y2="9" />`}
        <circle cx=${r(e.q)} cy="9" r=${o?5.5:4} />
      </svg>
      <span class="value-number">${H(e.q)}</span>
    </span>
  </li>`}function io(e){let t=e.flatMap(o=>[o.q-2*(o.stderr??0),o.q+2*(o.stderr??0)]).filter(W),n=Math.min(...t),s=Math.max(...t)-n||1;return o=>Math.min(1,Math.max(0,(o-n)/s))}var Vt=new Map,ls=e=>e.margin<0?e.action:e.other,ro=e=>({operator:", which an operator has asked for",script:", which a script has asked for"})[e.chosen_by]??"";function cs(){let[e,t]=$(""),[n,s]=$(null),[o,i]=$(null),r=b.value?.step,{name:c}=x.value;if(M(()=>t(""),[c,r]),M(()=>{if(!r)return;let l=`/v1/missions/${encodeURIComponent(c)}/decisions/${r}/why?instead=${encodeURIComponent(e)}`;if(i(null),s(Vt.get(l)??null),Vt.has(l))return;let p=!0,u=setTimeout(()=>I(l).then(h=>{b.value?.status&&Vt.set(l,h),p&&s(h)},h=>p&&i(h)),150);return()=>{p=!1,clearTimeout(u)}},[c,r,e]),!r)return a`<p class="empty">There is no decision yet.</p>`;let d=(ve.value?.decided?.actions??[]).map(l=>l.action).filter(l=>l!==b.value.action);return a`<div class="why" aria-busy=${!n&&!o}>
    <p class="why-head">Why <span class="action">${b.value.action}</span>${n&&ro(n)}
      <label> and not <select value=${e} onChange=${l=>t(l.target.value)}>
        <option value="">the runner-up${n&&!e?`, ${n.other}`:""}</option>
        ${d.map(l=>a`<option value=${l}>${l}</option>`)}
      </select></label></p>
    <${P} problem=${o} />
    ${!n&&!o&&a`<p class="empty">An engine of its own is brought to this step…</p>`}
    ${n&&a`<${ao} why=${n} />`}
    ${r&&a`<${fo} key=${`${c} ${r}`} name=${c} step=${r} />`}
  </div>`}var ao=({why:e})=>a`<div class="columns even">
  <${E} id="margin" title="Where the margin comes from" note=${lo(e)}><${co} why=${e} /><//>
  <div class="stack">
    <${E} id="flips" title="At which belief the choice changes" note=${e.flips?.length?"Coloured: the action that is better now. Grey: the other one. The line is the belief now.":""}><${uo} why=${e} /><//>
    <${E} id="leads" title="What each response leads to"><${po} why=${e} /><//>
  </div>
</div>`;function lo(e){if(e.is_close){let n=e.simulations_to_tell?`about ${e.simulations_to_tell.toLocaleString("en")} simulations would tell`:"no number of simulations is sure to tell";return`Too close to call against ${e.other}: ${n}.`}let t=e.margin_stderr>=.005?` ± ${L(e.margin_stderr)}`:"";return`${H(e.margin)}${t} over ${e.other}, ${e.is_exact?"exactly":`by ${e.planner}`}.`}function co({why:e}){let[t,n]=z(),s=(e.terms??[]).map(l=>({...l,margin:l.value-l.other})).filter(l=>Math.abs(l.margin)>5e-4),o=(e.rest??0)-(e.other_rest??0);Math.abs(o)>5e-4&&s.push({place:"later steps",margin:o});let i=Math.max(...s.map(l=>Math.abs(l.margin)),1e-9),r=Math.max(80,n-(n<420?190:250)),c=l=>r/2+l/i*(r/2-2),d=j(x.value.name,"documents",x.value.step);return a`<div class="terms" ref=${t}>
    ${!s.length&&a`<p class="empty">${e.remark||"No line of the documents tells them apart."}</p>`}
    <ul>${s.slice(0,12).map(l=>a`<li aria-label=${`${H(l.margin,3)} from ${l.place}`}>
      <span class="term-place">${l.place==="later steps"?l.place:a`<a href=${d}>${l.place}</a>`}</span>
      <svg width=${r} height="18" aria-hidden="true">
        <line class="rail" x1=${r/2} x2=${r/2} y1="0" y2="18" />
        <rect class=${l.margin>0?"for":"against"} x=${Math.min(c(0),c(l.margin))} y="4" width=${Math.max(1,Math.abs(c(l.margin)-c(0)))} height="10" rx="2" />
      </svg>
      <span class="number">${H(l.margin,2)}</span>
    </li>`)}</ul>
    ${e.remark&&s.length>0&&a`<p class="aside">${e.remark}</p>`}
  </div>`}function uo({why:e}){let[t,n]=z(),s=Math.max(100,n),o=r=>r*s,i=(e.flips??[]).slice(0,5);return a`<div class="flips" ref=${t}>
    ${!i.length&&a`<p class="empty">${e.remark||`No probability of one value makes ${ls(e)} better.`}</p>`}
    ${i.map(r=>{let c=(r.low+r.high)/2>r.now,[d,l]=c?[r.high,1]:[0,r.low],p=c?"above":"below",u=r.high-r.low>.001?`${p} a probability between ${N(r.low)} and ${N(r.high)}`:`${p} ${N((r.low+r.high)/2)}`;return a`<figure class="flip">
        <figcaption>P(<span class="code">${r.variable} = ${r.value}</span>) is ${N(r.now)}; ${Q(ls(e))} wins ${u}${r.is_checked?"":", not checked by planning"}</figcaption>
        <svg width=${s} height="22" aria-hidden="true">
          <rect class="this" x="0" y="3" width=${s} height="16" rx="3" />
          <rect class="between" x=${o(r.low)} y="3" width=${Math.max(1,o(r.high)-o(r.low))} height="16" />
          <rect class="other" x=${o(d)} y="3" width=${Math.max(1,o(l)-o(d))} height="16" rx="3" />
          <line class="now" x1=${o(r.now)} x2=${o(r.now)} y1="0" y2="22" />
        </svg>
      </figure>`})}
  </div>`}var po=({why:e})=>a`<ul class="leads">
  ${(e.expected??[]).map(t=>a`<li class=${t.is_seen?"is-seen":""}>
    <p><span class="response">${t.response}</span> <span class="muted">${re(t.probability)}</span>${t.is_seen&&a` <b>seen</b>`}</p>
    <p class="muted">${t.action?a`goal ${N(t.goal_probability??0)}; next would be <span class="response">${t.action}</span>, worth ${H(t.value)}`:`goal ${N(t.goal_probability??0)}; the mission would be over`}</p>
  </li>`)}
</ul>`;function fo({name:e,step:t}){let[n,s]=$({forbid:"",without:"",believe:"",change:""}),[o,i]=$(null),[r,c]=$(null),[d,l]=$(!1);if(!q())return null;let p=[["forbid","Without this action now",b.value?.action??""],["without","Without this skill for good",b.value?.skill??""],["believe","With another belief","variable=value:0.5"],["change","With another number in the documents","file:line=number"]];async function u(h){h.preventDefault(),l(!0),c(null);let f={};for(let[v]of p)n[v].trim()&&(f[v]=[n[v].trim()]);try{i(await oe(`/v1/missions/${encodeURIComponent(e)}/decisions/${t}/whatif`,f))}catch(v){i(null),c(v)}l(!1)}return a`<${E} id="whatif" title="What if" className="whatif" note="The step is decided anew; the mission is not touched.">
    <form onSubmit=${u}>
      ${p.map(([h,f,v])=>a`<label class="field">${f}<input value=${n[h]} placeholder=${v} onInput=${m=>s({...n,[h]:m.target.value})} /></label>`)}
      <button class="primary" disabled=${d}>${d?"Deciding…":"Decide anew"}</button>
    </form>
    <div role="status">${o&&a`<p class="supposed">${o.action===o.before?"Still ":"Then "}<b class="action">${o.action}</b>, worth <b>${H(o.value)}</b>${o.action===o.before?"":a`, in place of ${o.before} with ${H(o.value_before)}`}.</p>
      ${(o.supposed??[]).map(h=>a`<p class="muted">Supposed: ${h}</p>`)}
      ${o.remark&&a`<p class="muted">${o.remark}</p>`}`}</div>
    <${P} problem=${r} />
  <//>`}var ds=()=>a`<div class="columns even">
  <${ho} />
  <${E} id="expected" title="Expected against seen" note="The ring is how often the model expected a response, the dot how often it came; the bar holds the true frequency with 95 %.">
    <${_o} />
  <//>
  <${E} id="strip" title="Decision strip" note="What was chosen at which probability, in this mission. The larger a dot, the more often.">
    <${$o} />
  <//>
</div>`;function ho(){let e=ut.value;return e.length?a`<${E} id="alarms" title="The model does not hold" className="alarms" note="Where the model is right, the probability that any such alarm ever comes is 1 % at most.">
    <div class="scroll" tabindex="0" role="region" aria-label="Table of alarms"><table>
      <thead><tr><th>Skill</th><th>Response</th><th class="num">Modelled</th><th class="num">Seen</th><th class="num">Uses</th><th class="num" title="The step at which it began">Since</th></tr></thead>
      <tbody>${e.map(t=>a`<tr onClick=${()=>F(t.since)}>
        <td class="action">${t.skill}</td><td class="response">${t.response}</td>
        <td class="num">${L(t.modelled)}</td><td class="num mark">${L(t.seen)}</td><td class="num">${t.uses}</td>
        <td class="num"><button class="row-step" aria-label=${`Step ${t.since}`}>${t.since}</button></td>
      </tr>`)}</tbody>
    </table></div>
  <//>`:null}function mo(){let e=new Map;for(let t of S.value){if(t.status!=="observed")continue;e.has(t.skill)||e.set(t.skill,{uses:0,responses:new Map});let n=e.get(t.skill);n.uses++;let s=new Set([...Object.keys(t.predicted??{}),t.seen]);for(let o of s){let i=n.responses.get(o)??{expected:0,seen:0};i.expected+=t.predicted?.[o]??0,o===t.seen&&i.seen++,n.responses.set(o,i)}}return e}function vo(e,t){let s=e/t,o=(s+1.96*1.96/(2*t))/(1+1.96*1.96/t),i=1.96*Math.sqrt(s*(1-s)/t+1.96*1.96/(4*t*t))/(1+1.96*1.96/t);return[Math.max(0,o-i),Math.min(1,o+i)]}function _o(){let[e,t]=z(),n=mo(),s=Math.max(90,t-(t<480?132:250)),o=i=>8+i*(s-16);return a`<div class="expected" ref=${e}>
    ${!n.size&&a`<p class="empty">Nothing has been observed yet.</p>`}
    ${[...n].map(([i,{uses:r,responses:c}])=>a`<div class="skill" key=${i}>
      <h3>${i} <span class="muted">${r} ${r===1?"use":"uses"}</span></h3>
      <ul>${[...c].sort((d,l)=>l[1].seen-d[1].seen).map(([d,{expected:l,seen:p}])=>{let[u,h]=vo(p,r),f=l/r,v=f<u||f>h;return a`<li class=${v?"is-off":""} aria-label=${`${d}: expected ${re(f)}, seen ${re(p/r)}, ${p} of ${r}${v?", outside of the interval":""}`}>
          <span class="response-name">${d}</span>
          <svg width=${s} height="18" aria-hidden="true">
            <line class="rail" x1="8" x2=${s-8} y1="9" y2="9" />
            <line class="error" x1=${o(u)} x2=${o(h)} y1="9" y2="9" />
            <circle class="ring" cx=${o(f)} cy="9" r="5.5" />
            <circle class="dot" cx=${o(p/r)} cy="9" r="3.5" />
          </svg>
          <span class="number">${p}/${r}${v?a` <b title="The model's frequency is outside of the interval">!</b>`:""}</span>
        </li>`})}</ul>
    </div>`)}
  </div>`}function $o(){let[e,t]=z(),[n,s]=$(""),i=Bt(V.value).filter(m=>m.isDoubtful).flatMap(m=>m.values.filter(_=>_!=="…"&&!(_==="false"&&m.values.includes("true"))).map(_=>`${m.name} = ${_}`)),r=i.includes(n)?n:i[0];if(!r)return a`<div ref=${e}><p class="empty">No variable is in doubt.</p></div>`;let[c,d]=r.split(" = "),l=new Map;S.value.forEach((m,_)=>{let g=V.value[_]?.[c]?.[d]??0;l.has(m.action)||l.set(m.action,[]),l.get(m.action).push({share:g,step:m})});let p=28,u=t<480,h=Math.max(120,t-(u?120:190)),f=m=>10+m*(h-20),v=[...l].sort((m,_)=>us(m[1])-us(_[1])).slice(0,14);return a`<div class="strip" ref=${e}>
    <label class="pick">Probability of <select value=${r} onChange=${m=>s(m.target.value)}>
      ${i.map(m=>a`<option value=${m}>${m}</option>`)}</select></label>
    <div class="strip-rows">
      ${v.map(([m,_])=>a`<div class="strip-row" key=${m}>
        <span class="value-name" title=${m}>${Q(m)}</span>
        <svg width=${h} height=${p} role="img" aria-label=${`${m}: chosen at ${_.slice(0,12).map(g=>N(g.share)).join(", ")}`}>
          <line class="rail" x1="10" x2=${h-10} y1=${p/2} y2=${p/2} />
          ${go(_).map(({share:g,at:y})=>a`<circle class=${y.includes(b.value)?"is-now":""} cx=${f(g)} cy=${p/2} r=${Math.min(12,3.5+1.5*Math.sqrt(y.length))} onClick=${()=>F(y[0].step)}><title>${`${N(g)}: ${y.length>1?`${y.length} steps`:`step ${y[0].step}`}`}</title></circle>`)}
        </svg>
      </div>`)}
      <div class="strip-row axis" aria-hidden="true"><span></span><span class="axis-ends" style=${{width:`${h}px`}}><i>0</i><i>½</i><i>1</i></span></div>
    </div>
  </div>`}function go(e){let t=new Map;for(let{share:n,step:s}of e){let o=Math.round(n*100);t.has(o)||t.set(o,{share:n,at:[]}),t.get(o).at.push(s)}return[...t.values()]}var us=e=>e.reduce((t,n)=>t+n.share,0)/e.length;var ps=()=>a`<div class="columns">
  <${E} id="all-steps" title="Steps" className="wide"><${Gt} /><//>
  <${E} id="activation" title=${b.value?`Activation of step ${b.value.step}`:"Activation"}><${yo} /><//>
</div>`,$t=150;function Gt(){let e=ce(null),[t,n]=$(!1),s=b.value?.step,o=S.value,i=o.length>$t&&!t,r=i?Math.max(0,Math.min(o.length-$t,Math.round((te.value-$t/2)/25)*25)):0,c=i?o.slice(r,r+$t):o;return M(()=>{let d=e.current?.querySelector("[aria-selected=true]"),l=e.current?.closest(".scroll");d&&l&&(d.offsetTop<l.scrollTop+30||d.offsetTop+d.offsetHeight>l.scrollTop+l.clientHeight)&&(l.scrollTop=d.offsetTop-l.clientHeight/2)},[s]),a`<div class="scroll" tabindex="0" role="region" aria-label="Table of steps">
    <table class="steps">
      <thead><tr><th>Step</th><th>Action</th><th class="num wide-only">Value</th><th>Seen</th><th class="num wide-only">Expected</th><th class="num">Surprise</th><th class="num wide-only">Goal</th></tr></thead>
      <tbody ref=${e}>${c.map(d=>a`<${bo} key=${d.step} step=${d} isNow=${d.step===s} />`)}</tbody>
    </table>
    ${i&&a`<button class="link" onClick=${()=>n(!0)}>Show all ${o.length} steps</button>`}
  </div>`}var bo=({step:e,isNow:t})=>a`<tr aria-selected=${t} onClick=${()=>F(e.step)}>
  <td><button class="row-step" aria-label=${`Step ${e.step}`}>${e.step}</button></td>
  <td class="action" title=${e.action}>${Q(e.action)}</td>
  <td class="num wide-only">${H(e.value)}</td>
  <td>${e.status?He(e)?a`<span class="bad">✕ ${e.status.replace("_"," ")}</span>`:e.seen:a`<span class="muted">running</span>`}</td>
  <td class="num wide-only">${e.status?N(e.expected):""}</td>
  <td class="num">${e.status?a`${We(e)?a`<span class="mark" aria-label="surprising">▲ </span>`:""}${e.impossible?"∞":L(e.surprise)}`:""}</td>
  <td class="num wide-only">${N((e.endings_after??e.endings)?.goal)}</td>
</tr>`;function yo(){let e=ve.value,t=b.value;if(!t||!e)return a`<p class="empty">There is no step yet.</p>`;let n=e.observed??e.decided,s=e.observed?.outcome,o=s?(s.ended_ns-s.started_ns)/1e9:null,i=Object.entries(s?.local_variables??{});return a`<div class="activation">
    <p class="big-action">${t.action}</p>
    <dl class="facts">
      <div><dt>Outcome</dt><dd>${s?`${s.status.replace("_"," ")}${s.response?`: ${s.response}`:""}`:"running"}</dd></div>
      ${o!==null&&a`<div><dt>Took</dt><dd>${Ue(o)}</dd></div>`}
      <div><dt>Decided in</dt><dd>${Ue(n.planning_s)}${n.planner?`, by ${n.planner}`:""}</dd></div>
      ${n.why&&a`<div><dt>Why this planner</dt><dd>${n.why}</dd></div>`}
      <div><dt>Look-ahead</dt><dd>${n.horizon} decisions</dd></div>
      <div><dt>Model</dt><dd>revision ${n.revision}, <code>${n.model_digest.slice(0,12)}</code></dd></div>
      <div><dt>Belief</dt><dd>${n.belief.states.toLocaleString("en")} ${n.belief.states===1?"state":"states"}, ${n.belief.is_exact?"exact":"sampled"}</dd></div>
      ${Object.entries(s?.numbers??{}).map(([r,c])=>a`<div><dt>${r}</dt><dd>${JSON.stringify(c)}</dd></div>`)}
      ${Object.entries(s?.monitors??{}).map(([r,c])=>a`<div><dt>${r}</dt><dd>${c}</dd></div>`)}
    </dl>
    <h3>Local variables</h3>
    ${i.length?a`<dl class="facts mono">${i.map(([r,c])=>a`<div><dt>${r}</dt><dd>${c}</dd></div>`)}</dl>`:a`<p class="empty">${s?"The mapping has none.":"They come with the outcome."}</p>`}
  </div>`}function fs(){let[e,t]=$(null),[n,s]=$(null),[o,i]=$(""),r=b.value,c=r?.revision??0,{name:d}=x.value;if(M(()=>{let f=!0;return I(`/v1/missions/${encodeURIComponent(d)}/documents?revision=${c}`).then(v=>f&&(t(v),s(null)),v=>f&&s(v)),()=>f=!1},[d,c,!!D.value]),M(()=>i(""),[r?.skill]),n)return a`<${P} problem=${n} />`;if(!e)return a`<p class="empty">Reading the documents…</p>`;let l=(e.skills[r?.skill]??[]).filter(f=>f.what==="model"||f.what===`rule ${r?.seen}`),p=o||l[0]?.file||e.files[0]?.name,u=e.files.find(f=>f.name===p)?.text??"",h=l.map(f=>f.file);return a`<${E} id="documents" title=${`Documents of ${e.project}`} note=${`Revision ${e.revision}${r?`; the lines of ${r.skill} are marked`:""}.`}>
    <div class="files" role="tablist" aria-label="Files">
      ${e.files.map(f=>a`<button role="tab" aria-selected=${f.name===p} class=${h.includes(f.name)?"is-about":""} onClick=${()=>i(f.name)}>${f.name}</button>`)}
    </div>
    <${wo} key=${p} text=${u} marked=${l.filter(f=>f.file===p)} />
  <//>`}function wo({text:e,marked:t}){let n=ce(null);return M(()=>{let s=n.current?.querySelector(".is-marked");s&&(n.current.scrollTop=Math.max(0,s.offsetTop-60))},[t.map(s=>s.first).join()]),a`<pre class="source" ref=${n} tabindex="0"><code>${e.split(`
`).map((s,o)=>{let i=t.find(r=>r.first<=o+1&&o+1<=r.last);return a`<span class=${i?"line is-marked":"line"} data-line=${o+1}>${s||" "}\n</span>`})}</code></pre>`}function hs(){let e=D.value,[t,n]=$(null),[s,o]=$(null),[i,r]=$([]),[c,d]=$(""),[l,p]=$(""),[u,h]=$(null),f=e&&encodeURIComponent(e.run);M(()=>{f&&(I(`/v1/runs/${f}`).then(n,h),I(`/v1/runs/${f}/services`).then(o,h),I(`/v1/runs/${f}/bundles`).then(_=>r(_.entries),()=>r([])))},[f,Pe.value.length,fe.value.size]);let v=s?.services.find(_=>_.service==="solver")?.service??s?.services[0]?.service,m=c||v;return M(()=>{if(!f||!m)return;let _=()=>jn(`/v1/runs/${f}/logs/${m}?tail=60000`).then(p,h);_();let g=e.is_running?setInterval(_,2e3):null;return()=>clearInterval(g)},[f,m,e?.is_running]),e?a`<div class="columns">
    <${E} id="logs" title="Logs" className="wide">
      <div class="files" role="tablist" aria-label="Processes">
        ${(s?.services??[]).map(_=>a`<button role="tab" aria-selected=${_.service===m} onClick=${()=>d(_.service)}>
          ${e.is_running&&a`<i class=${`presence ${fe.value.get(_.service)?"is-there":""}`} title=${fe.value.get(_.service)?"on the bus":"not on the bus"}></i>`}${_.service}</button>`)}
      </div>
      <pre class="source log" tabindex="0" aria-label=${`Log of ${m}`}>${l||"The log is empty."}</pre>
      <${P} problem=${u} />
    <//>
    <div class="stack">
      <${E} id="run" title="Run">
        ${t&&a`<dl class="facts">
          <div><dt>Robot</dt><dd>${t.robot}</dd></div>
          <div><dt>Started</dt><dd>${ft(t.started)}</dd></div>
          <div><dt>Deploy file</dt><dd class="path">${t.deploy_file}</dd></div>
          <div><dt>Directory</dt><dd class="path">${t.directory}</dd></div>
          <div><dt>Seed</dt><dd>${e.mission?.seed??t.seed}</dd></div>
          ${t.is_played&&a`<div><dt>Skills</dt><dd>played by their documents</dd></div>`}
          ${t.sandbox&&a`<div><dt>Documents</dt><dd>${t.sandbox}</dd></div>`}
        </dl>`}
        ${(s?.ends??[]).map(_=>a`<p class="aside"><b>${_.name}</b> ended after ${_.after_s.toFixed(1)} s, ${_.how}: ${_.then}</p>`)}
      <//>
      <${E} id="bundles" title="Documents">
        <ul class="bundles">${i.map(_=>a`<li><b>${_.project}</b> revision ${_.revision}<span class="muted">${_.skills.join(", ")}</span></li>`)}</ul>
        ${e.is_running&&a`<${xo} run=${e.run} />`}
      <//>
    </div>
  </div>`:null}function xo({run:e}){let[t,n]=$(null),[s,o]=$("");async function i(r){let c=r.target.files[0];if(c){o(`Sending ${c.name}…`),n(null);try{let d=await lt(`/v1/runs/${encodeURIComponent(e)}/bundles`,c),l=[...d.added??[],...d.changed??[]].join(", ");o(`Accepted: revision ${d.revision}${l?`, ${l}`:", nothing new"}.`)}catch(d){o(""),n(d)}r.target.value=""}}return a`<div class="push">
    ${q()?a`<label class="button">Give it documents…<input type="file" class="visually-hidden" onChange=${i} accept=".zip,.tar,.gz,.tgz,.xz,.bz2,.ef,.sd,.am,.lf,.json" /></label>
          <p class="note">A document, or an archive of some. They take over at a decision, and the mission goes on.</p>`:a`<p class="note">Open the address that <code>aos serve</code> prints to change something here.</p>`}
    <p role="status">${s}</p>
    <${P} problem=${t} />
  </div>`}var ko={overview:"Overview",why:"Why",steps:"Steps",model:"Model",documents:"Documents",system:"System"},So={overview:To,why:cs,steps:ps,model:ds,documents:fs,system:hs};function ms(){let{name:e,view:t}=x.value;M(()=>(pt(e),Hn),[e]);let n=b.value?.step,s=b.value&&!b.value.status;if(M(()=>{if(!n)return;let i=setTimeout(()=>zn(n),60);return()=>clearTimeout(i)},[e,n,s]),X.value&&!D.value)return a`<main id="main" class="page"><h1>${e}</h1><${P} problem=${X.value} /><p><a href="#/">All missions</a></p></main>`;let o=So[t];return a`<main id="main" class="page">
    <${Mo} />
    <${Yn} />
    <div class="hero card">
      <${ss} />
      <${ns} />
    </div>
    <nav class="views" aria-label="Views">
      ${jt.map(i=>a`<a href=${j(e,i,x.value.step)} aria-current=${i===t?"page":null}>${ko[i]}</a>`)}
    </nav>
    <${o} />
  </main>`}function Mo(){let e=D.value,t=T.value,n=t?.phase==="ended",s=b.value&&(me.value||b.value===De.value?b.value.endings_after??b.value.endings:b.value.endings_after??b.value.endings),o=s?.goal??t?.goal_probability;return a`<header class="head">
    <div class="head-name">
      <h1>${e?.robot??" "}</h1>
      <p class="muted">${x.value.name}</p>
    </div>
    <div class="head-state">
      <p class=${`phase is-${n?t.ending:t?.phase??"waiting"}`} role="status">
        <i class=${n||!e?.is_running?"still-dot":"pulse"}></i>${n?ht(t.ending):Vn(t?.phase??"waiting")}
        ${!me.value&&a`<span class="past">showing step ${b.value?.step}</span>`}
      </p>
      <p class="remark">${t?.remark??""}</p>
      <${Co} />
    </div>
    <div class="goal" title="How probable the goal is, as the belief has it">
      <span class="goal-number">${N(o)}</span><span class="goal-word">goal</span>
      <svg viewBox="0 0 100 4" preserveAspectRatio="none" aria-hidden="true"><rect width="100" height="4" class="goal-rail" /><rect width=${(o??0)*100} height="4" class="goal-bar" /></svg>
      ${s?.failure>5e-4&&a`<span class="failure">failure ${N(s.failure)}</span>`}
    </div>
    <${Zn} />
  </header>`}function Co(){let e=[...new Set(ut.value.map(s=>s.skill))];if(!e.length)return null;let{name:t,step:n}=x.value;return a`<p><a class="alarm" href=${j(t,"model",n)}><svg width="11" height="11" viewBox="0 0 10 10" aria-hidden="true"><path d="M5 0 l5 9.5 h-10z" /></svg>The model of ${e.join(", ")} does not hold</a></p>`}function To(){return a`<div class="columns overview">
    <div class="stack">
      <${E} id="belief" title="Belief" note=${Eo()}><${is} /><//>
      <${E} id="all-steps" title="Steps"><${Gt} /><//>
    </div>
    <div class="stack">
      <${E} id="values" title="Values of the actions"><${as} /><${Qn} /><//>
      ${J.value.length>0&&a`<${E} id="world" title="World"><${No} /><//>`}
    </div>
  </div>`}var Eo=()=>V.value.length?`After ${me.value?"the newest step":`step ${b.value?.step}`}.`:"";function No(){let e=J.value,t=b.value?.step??0,n=e.filter(s=>s<=t).at(-1)??e[0];return n===void 0?null:a`<figure class="picture"><img src=${`/v1/missions/${encodeURIComponent(x.value.name)}/world/${n}`} alt=${`The world after step ${n}`} />
    <figcaption class="note">After step ${n}</figcaption></figure>`}var Kt="aos-theme",vs=e=>e?document.documentElement.dataset.theme=e:delete document.documentElement.dataset.theme;vs(localStorage.getItem(Kt));var Oo={live:"Live",lost:"Connection lost, trying again",connecting:"Connecting",over:"Recorded"};function Ao(){let{kind:e,name:t}=x.value,n=e==="missions"&&t;return M(()=>{e==="runs"&&t?Ro(t):n||(Fe(),dt())},[e,t]),a`
    <a class="skip" href="#main" onClick=${s=>{s.preventDefault(),document.getElementById("main")?.focus()}}>To the content</a>
    <header class="bar">
      <a class="brand" href="#/" aria-label="AOS, all missions"><svg viewBox="0 0 32 32" width="22" height="22" aria-hidden="true"><rect width="32" height="32" rx="8" /><path d="M6 21c5 0 5-10 10-10s5 10 10 10" /><circle cx="16" cy="11" r="3.2" /></svg><span>AOS</span></a>
      ${n&&a`<nav aria-label="Place"><a href="#/">Missions</a></nav>`}
      <span class="room"></span>
      <span class=${`connection is-${Z.value}`} role="status"><i></i>${n||Z.value==="lost"?Oo[Z.value]:""}</span>
      <${Io} />
    </header>
    ${n?a`<${ms} key=${t} />`:a`<${Kn} />`}`}async function Ro(e){await Fe();let t=(xe.value??[]).find(n=>n.run===e);ie(j(t?.missions?.at(-1)??e),{replace:!0})}function Io(){let[e,t]=$(localStorage.getItem(Kt)??""),n=e?e==="dark":matchMedia("(prefers-color-scheme: dark)").matches;function s(){let o=n?"light":"dark";localStorage.setItem(Kt,o),vs(o),t(o)}return a`<button class="quiet theme" onClick=${s} aria-label=${n?"Light colours":"Dark colours"} title=${n?"Light colours":"Dark colours"}>${n?"☀":"☾"}</button>`}addEventListener("keydown",e=>{if(!(e.target instanceof Element&&e.target.closest("input, select, textarea, .scroll, .source, [role=tab]")||e.ctrlKey||e.metaKey||e.altKey||!b.value)){if(e.key==="ArrowLeft")F(b.value.step-1);else if(e.key==="ArrowRight")F(b.value.step+1);else if(e.key==="Home")F(S.value[0].step);else if(e.key==="End")F(null);else return;e.preventDefault()}});await Dn();Mt(a`<${Ao} />`,document.getElementById("page"));
